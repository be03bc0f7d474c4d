brace_test(raycast_test LABEL gpu LIBRARIES brace::raycast brace::reference hwy::hwy nlohmann_json::nlohmann_json SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/raycast/extremes_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/host_braces_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/integrators_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/integrate_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/layout_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/path_choice_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/picture_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/raycast_fixture.cpp)
target_compile_definitions(raycast_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
  BRACE_DATA_FOLDER="${PROJECT_BINARY_DIR}/share/brace")
