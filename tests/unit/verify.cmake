brace_test(verify_test LABEL gpu LIBRARIES brace::verify nlohmann_json::nlohmann_json SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/verify/planted_in_casts.cpp
  ${CMAKE_CURRENT_LIST_DIR}/verify/planted_in_numbers.cpp
  ${CMAKE_CURRENT_LIST_DIR}/verify/planted_in_stereo_and_control.cpp
  ${CMAKE_CURRENT_LIST_DIR}/verify/verify_test.cpp)
target_compile_definitions(verify_test PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
