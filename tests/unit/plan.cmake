brace_test(plan_test LABEL unit LIBRARIES brace::plan nlohmann_json::nlohmann_json SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/plan/plan_test.cpp)
target_compile_definitions(plan_test PRIVATE BRACE_DATA_DIR="${PROJECT_BINARY_DIR}/share/brace")
