brace_test(metrics_test LABEL unit LIBRARIES brace::metrics SOURCES
  metrics/image_error_test.cpp)
