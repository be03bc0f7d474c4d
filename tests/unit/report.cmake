add_library(made_up_run STATIC ${CMAKE_CURRENT_LIST_DIR}/report/made_up_run.cpp)
target_link_libraries(made_up_run PUBLIC brace::report)
