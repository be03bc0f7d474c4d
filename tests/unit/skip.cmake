brace_test(skip_test LABEL gpu LIBRARIES brace::skip brace::host brace::raycast SOURCES
  skip/choose_test.cpp
  skip/images_test.cpp
  skip/oracle.cpp
  skip/partitioning_test.cpp
  skip/skip_fixture.cpp
  skip/structures_test.cpp)
target_include_directories(skip_test PRIVATE ${CMAKE_CURRENT_LIST_DIR})
target_compile_definitions(skip_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
