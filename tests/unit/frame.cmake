brace_test(frame_test LABEL unit
  LIBRARIES brace::frame brace::stages_predict brace::stages_control
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/frame/allocation_counter.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/cell_cuts_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/cell_schedule_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/chunked_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/counted_work_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/frame_loop_extremes_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/frame_loop_replay_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/frame_loop_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/gaze_motion_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/give_up_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/head_motion_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/load_control_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/pacing_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/stages_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/frame/transfer_update_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/frame/wall_clock_test.cpp)
