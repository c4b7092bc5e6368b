# Compiles the files of one folder of a target as one unit, so that their common headers and templates are read and
# instantiated once. This is for files that read and write text, whose headers take most of the time. Kernels stay units
# of their own.

# postlens_compile_together(TARGET [ALONE files...]): the files after ALONE stay units of their own.
function(postlens_compile_together target)
  if(NOT POSTLENS_UNITY)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "ALONE" ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder "${source}" DIRECTORY)
    if(IS_ABSOLUTE "${source}" OR source IN_LIST arg_ALONE)
      continue()
    endif()
    string(MAKE_C_IDENTIFIER "${target}_${folder}" group)
    set_source_files_properties("${source}" PROPERTIES UNITY_GROUP "${group}")
  endforeach()
endfunction()
