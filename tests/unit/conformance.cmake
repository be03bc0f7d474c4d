brace_test(conformance_test LABEL gpu LIBRARIES brace::conformance brace::bench_host SOURCES
  conformance/conformance_test.cpp
  conformance/host_bench_test.cpp
  conformance/kernel_parts_test.cpp
  conformance/native_steps_test.cpp
  conformance/watchdog_test.cpp)
target_include_directories(conformance_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(conformance_test PRIVATE
  BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
  BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace"
  EXAMPLE_PLUGINS="${PROJECT_BINARY_DIR}/example-plugins"
  BROKEN_PLUGINS="${PROJECT_BINARY_DIR}/broken-plugins")
