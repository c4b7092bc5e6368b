# Toolchain: compiles for 64-bit ARM on another machine, see scripts/check_aarch64.sh. POSTLENS_SYSROOT is a folder that
# Debian's arm64 packages were unpacked into.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
# Not that this is no longer as GCC 9 did it.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
# CMake reads this file again for every check that it compiles.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES POSTLENS_SYSROOT)
set(CMAKE_SYSROOT "${POSTLENS_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# Tests then run in the emulator too.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L "${POSTLENS_SYSROOT}")
