brace_test(accelerations_test LABEL gpu LIBRARIES brace::replay SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/accelerations/cell_poses_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/accelerations/first_hits_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/accelerations/levels_test.cpp)
target_compile_definitions(accelerations_test PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
