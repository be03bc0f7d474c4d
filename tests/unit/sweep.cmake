brace_test(sweep_test LABEL unit LIBRARIES brace::sweep nlohmann_json::nlohmann_json SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/sweep/results_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/sweep/sweep_file_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/sweep/sweep_page_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/sweep/work_precision_test.cpp)
