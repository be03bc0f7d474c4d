brace_test(compare_test LABEL unit LIBRARIES brace::compare brace::hmd_sim SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/compare/compare_test.cpp)
