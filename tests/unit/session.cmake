brace_test(session_test LABEL unit
  LIBRARIES brace::session
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/session/adversarial_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/keys_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/plan_keys_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/resolved_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/session_text.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/stage_parameters_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/transfer_keys_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/session/values_test.cpp)
