brace_test(live_test LABEL unit LIBRARIES brace::live brace_imgui SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/live/frame_history_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/head_control_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/head_readings_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/overlay_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/scale_choice_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/stage_panel_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/transfer_panel_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/view_colours_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/vsync_pace_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/live/window_picture_test.cpp)
brace_test(live_view_test LABEL gpu LIBRARIES brace::live_eyes SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/live/live_view_test.cpp)
target_compile_definitions(live_view_test PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
