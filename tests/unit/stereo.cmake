brace_test(stereo_test LABEL unit LIBRARIES brace::stereo SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/stereo/layer_count_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stereo/rectification_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stereo/scan_line_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stereo/stereo_plan_test.cpp)
