// Files that are read as a whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace postlens {

/// Throws Error(invalid_input) "FILE: ..." unless the path is a readable regular file; returns its size in
/// bytes.
std::uintmax_t check_regular_file(const std::filesystem::path& path);

/// The whole file as text. Throws Error(invalid_input) if the path is not a readable regular file, or if the
/// file is larger than `largest_bytes`.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path, std::uintmax_t largest_bytes);

}  // namespace postlens
