brace_test(gpu_test LABEL gpu LIBRARIES brace::gpu SOURCES
  gpu/commands_test.cpp
  gpu/device_test.cpp
  gpu/memory_test.cpp
  gpu/shader_compiler_test.cpp)
target_include_directories(gpu_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
