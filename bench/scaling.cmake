target_sources(brace_bench PRIVATE ${CMAKE_CURRENT_LIST_DIR}/tile_schedule.cpp)
