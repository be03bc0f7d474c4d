brace_test(host_test LABEL unit LIBRARIES brace::host SOURCES
  host/plugin_library_test.cpp
  host/left_out_test.cpp
  host/native_stage_test.cpp
  host/stage_manifest_test.cpp
  host/stage_registry_test.cpp
  host/stage_glsl_test.cpp)
target_compile_definitions(host_test PRIVATE
  BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
  EXAMPLE_PLUGINS="${PROJECT_BINARY_DIR}/example-plugins"
  BROKEN_PLUGINS="${PROJECT_BINARY_DIR}/broken-plugins")
