# Three programs: each has a rig of its own.
brace_test(stereo_matrix_test LABEL gpu LIBRARIES brace::replay SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/stereo_matrix/stereo_matrix_test.cpp)
brace_test(stereo_extremes_test LABEL gpu LIBRARIES brace::replay brace::reference SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/stereo_matrix/stereo_extremes_test.cpp)
brace_test(stereo_atlas_test LABEL gpu LIBRARIES brace::replay SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/stereo_matrix/stereo_atlas_test.cpp)
foreach(test stereo_matrix_test stereo_extremes_test stereo_atlas_test)
  target_compile_definitions(${test} PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
endforeach()
