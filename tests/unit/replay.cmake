brace_test(replay_test LABEL unit
  LIBRARIES brace::replay
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/replay/head_trace_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/replay/headset_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/replay/ideal_cache_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/replay/place_volume_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/replay/vsync_selection_test.cpp)
target_compile_definitions(replay_test PRIVATE BRACE_DATA_DIR="${PROJECT_BINARY_DIR}/share/brace")
