brace_test(sweep_test LABEL unit LIBRARIES brace::sweep SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/sweep/results_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/sweep/sweep_file_test.cpp)
