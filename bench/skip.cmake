brace_library(bench_skip
  skip.cpp
  skip_frames.cpp
  skip_published.cpp
  skip_octants.cpp
  skip_plot.cpp
  skip_scenes.cpp
  skip_text.cpp
  skip_threshold.cpp)
target_link_libraries(brace_bench_skip PUBLIC brace::gpu PRIVATE
  brace::host brace::raycast brace::skip nlohmann_json::nlohmann_json)
target_link_libraries(brace_bench PUBLIC brace::bench_skip)

brace_data(bench data/pdm_table1.csv)
brace_data(bench/skip_published
  skip_published/merge.comp
  skip_published/occupancy.comp
  skip_published/transform.comp)
