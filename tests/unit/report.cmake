# Made-up records, shared with the page's test.
add_library(made_up_run STATIC ${CMAKE_CURRENT_LIST_DIR}/report/made_up_run.cpp)
target_link_libraries(made_up_run PUBLIC brace::report)

brace_test(report_test LABEL unit LIBRARIES made_up_run nlohmann_json::nlohmann_json SOURCES
  report/csv_test.cpp
  report/decimate_test.cpp
  report/page_test.cpp
  report/progress_test.cpp
  report/run_directory_test.cpp
  report/summary_test.cpp
  report/trace_events_test.cpp)
target_compile_definitions(report_test PRIVATE
  BRACE_PAGE_FOLDER="${PROJECT_BINARY_DIR}/share/brace/report")
