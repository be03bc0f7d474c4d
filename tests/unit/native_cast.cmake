brace_test(native_cast_test LABEL unit LIBRARIES brace::host SOURCES native_cast/native_cast_test.cpp native_cast/native_cast_rig.cpp)
target_compile_definitions(native_cast_test PRIVATE
  NATIVE_CAST="${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}/brace/plugins/native_cast.so"
  REFERENCE_CAST="${PROJECT_BINARY_DIR}/example-plugins/reference_cast.so")
add_dependencies(native_cast_test native_cast reference_cast)
