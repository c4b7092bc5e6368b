# Compiler settings that every target of postlens shares, as the interface library postlens_options.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # With precompiled headers it keeps nothing unless told that neither their macros nor __TIME__ matter (nothing here says
  # __TIME__), and what the preprocessor writes has to name the header instead of repeating it.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND};-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;${CCACHE_PROGRAM}")
  if(POSTLENS_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-fpch-preprocess)
  endif()
endif()

# By default, GCC collects garbage in its own memory from 128 MB on. It compiles these files 10 % faster if it waits longer.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(--param=ggc-min-heapsize=524288)
endif()

# Saves most of the link time of tests and benchmarks, where it is installed (it comes with GNU's own linker).
find_program(POSTLENS_GOLD ld.gold)
if(POSTLENS_GOLD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_link_options(-fuse-ld=gold)
endif()

add_library(postlens_options INTERFACE)
target_include_directories(postlens_options INTERFACE "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
target_compile_features(postlens_options INTERFACE cxx_std_20)
# For postlens itself: who links the installed libraries has settings of their own.
set(postlens_compile_options
  # Settings are filled with designated initialisers; what is left out keeps its default.
  -Wall -Wextra -Wpedantic -Wno-missing-field-initializers -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual -Werror
  # No fused multiply-add, so that kernels give bit-identical results for every instruction set.
  -ffp-contract=off
  # errno and traps are never read; without these sqrt and selects do not vectorise.
  -fno-math-errno -fno-trapping-math)
target_compile_options(postlens_options INTERFACE "$<BUILD_INTERFACE:${postlens_compile_options}>")

if(POSTLENS_FUZZ)
  # Coverage feedback from every library; the targets themselves add libFuzzer's main.
  target_compile_options(postlens_options INTERFACE -fsanitize=fuzzer-no-link,address,undefined
    -fno-sanitize-recover=all -Wno-unknown-warning-option)
  target_link_options(postlens_options INTERFACE -fsanitize=address,undefined)
  target_compile_definitions(postlens_options INTERFACE POSTLENS_NO_MULTIVERSION)
endif()

if(POSTLENS_SANITIZE)
  target_compile_options(postlens_options INTERFACE
    -fsanitize=${POSTLENS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(postlens_options INTERFACE -fsanitize=${POSTLENS_SANITIZE})
  # Resolvers of multiversioned functions run before the sanitizers' run time is up.
  target_compile_definitions(postlens_options INTERFACE POSTLENS_NO_MULTIVERSION)
endif()

# One library per folder: postlens_library(NAME [FEW_LOOPS|NO_LOOPS] SOURCES sources... LINK libraries... PRIVATE libraries...).
# FEW_LOOPS: nothing in the folder takes long, so the compiler optimises it little and reads all of it at once.
# NO_LOOPS: the folder only reads arguments, calls other folders and writes reports. The compiler takes a third less time
# with -Og than with -O1, and programs are as fast.
set(few_loops_options $<$<CONFIG:Release>:-O1>)
set(no_loops_options $<$<CONFIG:Release>:-Og>)
function(postlens_library name)
  cmake_parse_arguments(arg "FEW_LOOPS;NO_LOOPS" "" "SOURCES;LINK;PRIVATE" ${ARGN})
  add_library(postlens_${name} STATIC ${arg_SOURCES})
  add_library(postlens::${name} ALIAS postlens_${name})
  target_link_libraries(postlens_${name} PUBLIC postlens_options ${arg_LINK} PRIVATE ${arg_PRIVATE})
  if(arg_FEW_LOOPS OR arg_NO_LOOPS)
    target_compile_options(postlens_${name} PRIVATE
      $<IF:$<BOOL:${arg_NO_LOOPS}>,${no_loops_options},${few_loops_options}>)
    postlens_compile_together(postlens_${name} WHOLE)
  else()
    postlens_use_precompiled(postlens_${name} postlens_library_headers)
    postlens_compile_together(postlens_${name})
  endif()
endfunction()
