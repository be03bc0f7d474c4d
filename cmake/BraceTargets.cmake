# brace_library(NAME SOURCES…): a static library target brace_NAME, alias brace::NAME, with the project's
# language level, warnings and include root (the repository's root: #include "folder/file.hpp").
add_library(brace_options INTERFACE)
target_compile_features(brace_options INTERFACE cxx_std_20)
target_compile_options(brace_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -ffp-contract=off)
target_include_directories(brace_options INTERFACE ${PROJECT_SOURCE_DIR})

function(brace_library name)
  add_library(brace_${name} STATIC ${ARGN})
  add_library(brace::${name} ALIAS brace_${name})
  target_link_libraries(brace_${name} PUBLIC brace_options)
  set_target_properties(brace_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  brace_precompile(brace_${name} libraries
    <algorithm> <cmath> <filesystem> <fstream> <functional> <map> <memory> <optional> <set> <span> <string> <vector>)
endfunction()

# brace_precompile(TARGET GROUP HEADERS…): the group's targets share one compiled form of these headers, where
# BRACE_PRECOMPILED_HEADERS is on. It is off for releases: there a missing #include is seen. Without fmt and glm: their
# pragmas and intrinsics do not survive it at -O0.
function(brace_precompile target group)
  if(NOT BRACE_PRECOMPILED_HEADERS)
    return()
  endif()
  get_property(owner GLOBAL PROPERTY brace_precompiled_${group})
  if(owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY brace_precompiled_${group} ${target})
  endif()
endfunction()

# brace_data(DESTINATION FILES…): files the program reads at run time. They lie under share/brace beside bin/
# in the build tree (links, so an edit is seen at once) and in the installed tree alike.
function(brace_data destination)
  set(folder ${PROJECT_BINARY_DIR}/share/brace/${destination})
  file(MAKE_DIRECTORY ${folder})
  foreach(file IN LISTS ARGN)
    get_filename_component(name ${file} NAME)
    get_filename_component(absolute ${file} ABSOLUTE)
    file(CREATE_LINK ${absolute} ${folder}/${name} SYMBOLIC)
  endforeach()
  install(FILES ${ARGN} DESTINATION ${CMAKE_INSTALL_DATADIR}/brace/${destination})
endfunction()

# brace_test(NAME LABEL LIBRARIES SOURCES…): a GoogleTest program; LABEL is unit, gpu, golden, …
# Leaks are looked for in unit tests alone: the software driver keeps 128 bytes of libxml2 until the end.
function(brace_test name)
  cmake_parse_arguments(arg "" "LABEL" "LIBRARIES;SOURCES" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE brace_options ${arg_LIBRARIES} GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  brace_precompile(${name} tests
    <algorithm> <cmath> <filesystem> <fstream> <map> <optional> <string> <vector>
    <gmock/gmock.h> <gtest/gtest.h> <nlohmann/json.hpp>)
  set(leaks "ASAN_OPTIONS=detect_leaks=0")
  if(arg_LABEL STREQUAL "unit")
    set(leaks "ASAN_OPTIONS=detect_leaks=1")
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS ${arg_LABEL} TIMEOUT 300 ENVIRONMENT "${leaks}")
endfunction()
