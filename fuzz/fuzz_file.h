// The fuzzer's bytes as a file with the ending that a reader goes by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace postlens {

/// Writes the bytes to one file per process, the same for every input, and gives its path.
inline std::filesystem::path fuzz_file(const std::uint8_t* data, std::size_t size,
                                       const std::string& ending) {
    const auto path =
        std::filesystem::temp_directory_path() / ("postlens_fuzz_" + std::to_string(::getpid()) + ending);
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path;
}

}  // namespace postlens
