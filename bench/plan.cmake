target_sources(brace_bench PRIVATE ${CMAKE_CURRENT_LIST_DIR}/plan.cpp)
target_link_libraries(brace_bench PRIVATE brace::plan)
