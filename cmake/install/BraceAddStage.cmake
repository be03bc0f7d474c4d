# brace_add_stage(NAME SOURCES…): a shared library NAME.so with stages in it, as Brace loads it: nothing visible but
# the entry, and no symbol left open that would only be missed when it is loaded.
function(brace_add_stage name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE Brace::stage)
  set_target_properties(${name} PROPERTIES
    PREFIX "" C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  # The runtime of a sanitizer lies in the program that loads the library: its symbols stay open.
  string(FIND "${CMAKE_C_FLAGS} ${CMAKE_CXX_FLAGS} ${CMAKE_MODULE_LINKER_FLAGS}" "-fsanitize" sanitized)
  if(sanitized EQUAL -1)
    target_link_options(${name} PRIVATE -Wl,-z,defs)
  endif()
endfunction()
