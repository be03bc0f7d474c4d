brace_test(warp_layers_test LABEL gpu LIBRARIES brace::replay SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/warp_layers/novel_view_test.cpp)
target_compile_definitions(warp_layers_test PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
