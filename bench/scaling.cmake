target_sources(brace_bench PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/scaling.cpp
  ${CMAKE_CURRENT_LIST_DIR}/scaling_text.cpp
  ${CMAKE_CURRENT_LIST_DIR}/tile_schedule.cpp)
