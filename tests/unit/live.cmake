brace_test(live_test LABEL unit LIBRARIES brace::live SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/live/head_control_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/window_picture_test.cpp)
