brace_test(gpu_test LABEL gpu LIBRARIES brace::gpu SOURCES
  gpu/commands_test.cpp
  gpu/device_test.cpp
  gpu/measurements_test.cpp
  gpu/memory_test.cpp
  gpu/shader_compiler_test.cpp)
target_include_directories(gpu_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})

brace_test(display_test LABEL gpu LIBRARIES brace::display brace::host SOURCES
  gpu/display_reference.cpp
  gpu/display_test.cpp
  gpu/display_warp_test.cpp
  gpu/grid_warp_test.cpp
  gpu/scan_out_warp_test.cpp)
target_include_directories(display_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(display_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

brace_test(swap_chain_test LABEL gpu LIBRARIES brace::gpu glfw SOURCES gpu/swap_chain_test.cpp)
target_include_directories(swap_chain_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
