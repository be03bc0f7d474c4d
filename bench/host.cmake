brace_library(bench_host host.cpp host_start.cpp)
target_link_libraries(brace_bench_host PUBLIC brace::gpu PRIVATE
  brace::allocation_count brace::host brace::raycast nlohmann_json::nlohmann_json)
target_link_libraries(brace_bench PUBLIC brace::bench_host)
