brace_test(hmd_sim_test LABEL unit LIBRARIES brace::hmd_sim SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/device_profile_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/gaze_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/generators_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/kalman_predictor_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/lens_profiles_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/lens_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/pose_trace_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/predictors_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/trace_io_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/tracker_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/hmd_sim/vsync_test.cpp)
target_compile_definitions(hmd_sim_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
