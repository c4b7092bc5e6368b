# Everything here is a Debian 12 package: scripts/install_dependencies.sh holds the same list.
find_package(fmt 9 REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
find_package(Imath 3.1 REQUIRED CONFIG)
find_package(OpenEXR 3.1 REQUIRED CONFIG)
find_package(OpenImageIO 2.4 REQUIRED CONFIG)
find_package(PNG 1.6.22 REQUIRED)
find_package(embree 3.13 REQUIRED CONFIG)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc quality)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto)
find_package(CLI11 2.1 REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(assimp 5.2 REQUIRED CONFIG)

# xxHash ships no CMake package on Debian 12; XXH3 is used header-only.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
add_library(xxhash_headers INTERFACE)
target_include_directories(xxhash_headers SYSTEM INTERFACE "${XXHASH_INCLUDE_DIR}")

# Nor does cpp-httplib.
find_path(HTTPLIB_INCLUDE_DIR httplib.h REQUIRED)
find_library(HTTPLIB_LIBRARY cpp-httplib REQUIRED)
add_library(cpp_httplib INTERFACE)
target_include_directories(cpp_httplib SYSTEM INTERFACE "$<BUILD_INTERFACE:${HTTPLIB_INCLUDE_DIR}>")
# As Debian has built it: these decide how its classes are laid out.
target_compile_definitions(cpp_httplib INTERFACE
  "$<BUILD_INTERFACE:CPPHTTPLIB_OPENSSL_SUPPORT;CPPHTTPLIB_ZLIB_SUPPORT;CPPHTTPLIB_BROTLI_SUPPORT>")
target_link_libraries(cpp_httplib INTERFACE "$<BUILD_INTERFACE:${HTTPLIB_LIBRARY}>" "$<INSTALL_INTERFACE:-lcpp-httplib>")

# FFTW ships none either; single precision, one thread a transform.
find_path(FFTW3F_INCLUDE_DIR fftw3.h REQUIRED)
find_library(FFTW3F_LIBRARY fftw3f REQUIRED)
add_library(fftw3f INTERFACE)
target_include_directories(fftw3f SYSTEM INTERFACE "$<BUILD_INTERFACE:${FFTW3F_INCLUDE_DIR}>")
target_link_libraries(fftw3f INTERFACE "$<BUILD_INTERFACE:${FFTW3F_LIBRARY}>" "$<INSTALL_INTERFACE:-lfftw3f>")

if(POSTLENS_PYTHON)
  # Debian's own: pybind11 and numpy are its packages.
  if(NOT Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python3_EXECUTABLE /usr/bin/python3)
  endif()
  find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter Development.Module NumPy)
  set(PYBIND11_FINDPYTHON OFF)
  set(PYTHON_EXECUTABLE "${Python3_EXECUTABLE}")
  find_package(pybind11 2.10 REQUIRED CONFIG)
endif()
