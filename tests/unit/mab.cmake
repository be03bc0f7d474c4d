brace_test(mab_test LABEL unit LIBRARIES brace::mab SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/mab/atlas_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mab/level_map_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mab/level_weights_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mab/live_texels_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mab/mab_plan_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mab/mab_property_test.cpp)
brace_test(mab_picture_test LABEL gpu LIBRARIES brace::replay SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/mab/mab_picture_test.cpp)
target_compile_definitions(mab_picture_test PRIVATE BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
