# What `cmake --install` adds to programs and data: the public headers, a place for plug-ins, and what the build
# systems of stage authors look for. The installed tree may be moved as a whole.
include(CMakePackageConfigHelpers)

install(FILES plugins/abi/brace_stage.h plugins/abi/brace_segments.h plugins/abi/glsl/brace/eye_params.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brace)
install(DIRECTORY DESTINATION ${CMAKE_INSTALL_LIBDIR}/brace/plugins)

# Brace::stage, what a native stage compiles with.
add_library(brace_stage INTERFACE)
target_include_directories(brace_stage INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
set_target_properties(brace_stage PROPERTIES EXPORT_NAME stage)
install(TARGETS brace_stage EXPORT brace_exports)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Brace)
set(data_folder ${CMAKE_INSTALL_DATADIR}/brace)
set(plugin_folder ${CMAKE_INSTALL_LIBDIR}/brace/plugins)
install(EXPORT brace_exports FILE BraceExports.cmake NAMESPACE Brace:: DESTINATION ${package_folder})
configure_package_config_file(cmake/install/BraceConfig.cmake.in ${PROJECT_BINARY_DIR}/install/BraceConfig.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS data_folder plugin_folder CMAKE_INSTALL_BINDIR)
# A stage for one major version of the interface keeps working; before 1.0 the minor version counts as well.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/install/BraceConfigVersion.cmake COMPATIBILITY SameMinorVersion
  ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/install/BraceConfig.cmake ${PROJECT_BINARY_DIR}/install/BraceConfigVersion.cmake
  cmake/install/BraceAddStage.cmake DESTINATION ${package_folder})

# pkg-config finds the prefix from where brace.pc lies.
file(RELATIVE_PATH prefix_from_pc /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" prefix_from_pc ${prefix_from_pc})
configure_file(cmake/install/brace.pc.in ${PROJECT_BINARY_DIR}/install/brace.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/install/brace.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The build tree is a prefix as well: who runs bin/brace from it can build stages against it.
foreach(header brace_stage.h brace_segments.h glsl/brace/eye_params.h)
  get_filename_component(header_name ${header} NAME)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_INCLUDEDIR}/brace)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/plugins/abi/${header}
    ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_INCLUDEDIR}/brace/${header_name} SYMBOLIC)
endforeach()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/${plugin_folder} ${PROJECT_BINARY_DIR}/${package_folder})
target_include_directories(brace_stage INTERFACE $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_INCLUDEDIR}>)
export(EXPORT brace_exports FILE ${PROJECT_BINARY_DIR}/${package_folder}/BraceExports.cmake NAMESPACE Brace::)
foreach(file ${PROJECT_BINARY_DIR}/install/BraceConfig.cmake ${PROJECT_BINARY_DIR}/install/BraceConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/install/BraceAddStage.cmake)
  configure_file(${file} ${PROJECT_BINARY_DIR}/${package_folder} COPYONLY)
endforeach()
