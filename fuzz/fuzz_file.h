// Writes the fuzzer's bytes to a file with the extension by which a reader is chosen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace postlens {

/// Writes the bytes to a temporary file and returns its path. A process uses the same file for every input.
inline std::filesystem::path fuzz_file(const std::uint8_t* data, std::size_t size,
                                       const std::string& ending) {
    const auto path =
        std::filesystem::temp_directory_path() / ("postlens_fuzz_" + std::to_string(::getpid()) + ending);
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path;
}

}  // namespace postlens
