// Bits of HTML that pages share.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// A picture inside the page: a data URL of the file's bytes; `type` is "png" or "svg+xml". Throws
/// Error(invalid_input) where it cannot be read.
[[nodiscard]] std::string picture_url(const std::filesystem::path& path, const char* type);

/// With <, >, & and " as entities.
[[nodiscard]] std::string html_escaped(const std::string& text);

}  // namespace postlens
