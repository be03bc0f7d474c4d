# brace_library(NAME SOURCES…): a static library target brace_NAME, alias brace::NAME, with the project's
# language level, warnings and include root (the repository's root: #include "folder/file.hpp").
add_library(brace_options INTERFACE)
target_compile_features(brace_options INTERFACE cxx_std_20)
target_compile_options(brace_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -ffp-contract=off)
if(NOT CMAKE_UNITY_BUILD)
  target_compile_options(brace_options INTERFACE -Wshadow)  # there files stand beside each other's names
endif()
target_include_directories(brace_options INTERFACE ${PROJECT_SOURCE_DIR})

function(brace_library name)
  add_library(brace_${name} STATIC ${ARGN})
  add_library(brace::${name} ALIAS brace_${name})
  target_link_libraries(brace_${name} PUBLIC brace_options)
  set_target_properties(brace_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

# brace_hot(FILES…): loops over whole tables, volumes or pictures, worth optimising in debug builds as well: the tests
# run them at every step.
function(brace_hot)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Debug>:-O1>")
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

# brace_test(NAME LABEL LIBRARIES SOURCES…): a GoogleTest program; LABEL is unit, gpu, cli, …
# CTest runs a program as one test: under the sanitizers a start costs more than most tests do. Those of the command
# are long and independent of each other: CTest runs them one by one.
# Leaks are looked for in unit tests alone: the software driver keeps 128 bytes of libxml2 until the end. Where it runs,
# freed memory is kept aside up to 16 MB (256 by default), which saves a tenth of a short run.
function(brace_test name)
  cmake_parse_arguments(arg "" "LABEL" "LIBRARIES;SOURCES" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE brace_options ${arg_LIBRARIES} GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  set(options "ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=16")
  if(arg_LABEL STREQUAL "unit")
    set(options "ASAN_OPTIONS=detect_leaks=1")
  endif()
  if(arg_LABEL STREQUAL "cli")
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
      PROPERTIES LABELS ${arg_LABEL} TIMEOUT 300 ENVIRONMENT "${options}")
  else()
    add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
    set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL} TIMEOUT 600 ENVIRONMENT "${options}")
  endif()
endfunction()
