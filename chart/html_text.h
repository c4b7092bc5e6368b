// HTML helpers that all pages share.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// Returns a data URL with the bytes of an image file. `type` is "png" or "svg+xml". Throws
/// Error(invalid_input) if the file cannot be read.
[[nodiscard]] std::string picture_url(const std::filesystem::path& path, const char* type);

/// Replaces <, >, & and " by HTML entities.
[[nodiscard]] std::string html_escaped(const std::string& text);

}  // namespace postlens
