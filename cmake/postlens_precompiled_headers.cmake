# Headers that most files include, parsed once instead of once a file: a fifth to a quarter of the time of a first build.
# Every file still names what it uses: scripts/check_tidy.sh and builds with the option off do without.
# The compiler takes such headers only for the flags they were made with. g++ also takes the level of optimisation of all
# functions from them, whatever the file's own options say.
if(POSTLENS_PRECOMPILED_HEADERS)
  set(postlens_common_headers
    <algorithm> <array> <cmath> <cstddef> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits> <map> <memory>
    <numbers> <numeric> <optional> <random> <set> <span> <string> <string_view> <utility> <vector>)
  # CMake makes them for a target with sources; this one has nothing to say.
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/precompiled.cpp" CONTENT "")
endif()

# postlens_precompile(NAME LINK libraries... HEADERS headers... OPTIONS options...): makes the set NAME.
function(postlens_precompile name)
  if(NOT POSTLENS_PRECOMPILED_HEADERS)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "LINK;HEADERS;OPTIONS" ${ARGN})
  add_library(${name} OBJECT "${PROJECT_BINARY_DIR}/precompiled.cpp")
  target_link_libraries(${name} PRIVATE postlens_options ${arg_LINK})
  target_compile_options(${name} PRIVATE ${arg_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${postlens_common_headers} ${arg_HEADERS})
endfunction()

# postlens_use_precompiled(TARGET NAME): the files of TARGET are compiled with the set NAME.
function(postlens_use_precompiled target name)
  if(POSTLENS_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()
