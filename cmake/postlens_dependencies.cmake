# Everything here is a Debian 12 package: scripts/install_dependencies.sh holds the same list.
find_package(fmt 9 REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
find_package(Imath 3.1 REQUIRED CONFIG)
find_package(OpenEXR 3.1 REQUIRED CONFIG)
find_package(OpenImageIO 2.4 REQUIRED CONFIG)
find_package(embree 3.13 REQUIRED CONFIG)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc quality)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto)
find_package(CLI11 2.1 REQUIRED)
find_package(Ceres 2.1 REQUIRED)

# xxHash ships no CMake package on Debian 12; XXH3 is used header-only.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
add_library(xxhash_headers INTERFACE)
target_include_directories(xxhash_headers SYSTEM INTERFACE "${XXHASH_INCLUDE_DIR}")

# FFTW ships none either; single precision, one thread a transform.
find_path(FFTW3F_INCLUDE_DIR fftw3.h REQUIRED)
find_library(FFTW3F_LIBRARY fftw3f REQUIRED)
add_library(fftw3f INTERFACE)
target_include_directories(fftw3f SYSTEM INTERFACE "${FFTW3F_INCLUDE_DIR}")
target_link_libraries(fftw3f INTERFACE "${FFTW3F_LIBRARY}")
