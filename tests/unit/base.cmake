brace_test(base_test LABEL unit LIBRARIES brace::base SOURCES base_test.cpp)
