brace_test(bench_test LABEL unit LIBRARIES brace::bench TBB::tbb SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/bench/tile_schedule_test.cpp)
