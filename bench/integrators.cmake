target_sources(brace_bench PRIVATE ${CMAKE_CURRENT_LIST_DIR}/integrators.cpp)
target_link_libraries(brace_bench PRIVATE brace::verify)
