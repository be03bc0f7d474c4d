brace_test(timeline_test LABEL unit
  LIBRARIES brace::timeline
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/timeline/cost_fit_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/timeline/cost_model_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/timeline/cost_source_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/timeline/costs_csv_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/timeline/event_queue_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/timeline/simulated_gpu_test.cpp)
target_compile_definitions(timeline_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
