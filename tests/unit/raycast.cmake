brace_test(raycast_test LABEL gpu LIBRARIES brace::raycast brace::reference SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/raycast/extremes_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/integrators_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/integrate_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/layout_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/picture_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raycast/raycast_fixture.cpp)
target_compile_definitions(raycast_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
