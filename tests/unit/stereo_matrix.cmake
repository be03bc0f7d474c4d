brace_test(stereo_matrix_test LABEL gpu LIBRARIES brace::replay SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/stereo_matrix/stereo_matrix_test.cpp)
target_compile_definitions(stereo_matrix_test PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
