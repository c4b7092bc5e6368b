# Compiles the files of one folder of a target as one unit, or with WHOLE all files of the target, so that their common
# headers and templates are read and instantiated once: the first build of the libraries takes half the time. A name in
# an anonymous namespace must be unique in its unit.
function(postlens_compile_together target)
  cmake_parse_arguments(arg "WHOLE" "" "" ${ARGN})
  if(NOT POSTLENS_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # g++ takes every file but the first for a header, in which an anonymous namespace would be a mistake.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  else()
    # A local variable may have the name of another file's constant.
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    set(folder "")
    if(NOT arg_WHOLE)
      get_filename_component(folder "${source}" DIRECTORY)
    endif()
    if(NOT IS_ABSOLUTE "${source}")
      string(MAKE_C_IDENTIFIER "${target}_${folder}" group)
      set_source_files_properties("${source}" PROPERTIES UNITY_GROUP "${group}")
    endif()
  endforeach()
endfunction()
