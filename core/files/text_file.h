// Reads whole files into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace postlens {

/// Returns the size of a file in bytes. Throws Error(invalid_input) "FILE: ..." unless the path is a readable
/// regular file.
std::uintmax_t check_regular_file(const std::filesystem::path& path);

/// Reads a whole file as text. Throws Error(invalid_input) if it is not a readable regular file, or is larger
/// than `largest_bytes`.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path, std::uintmax_t largest_bytes);

/// Returns the text without its UTF-8 byte order mark, which some programs write at the beginning of a file.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

}  // namespace postlens
