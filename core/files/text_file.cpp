#include "core/files/text_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace postlens {

std::uintmax_t check_regular_file(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        fail(ExitCode::invalid_input, "{}: cannot read ({})", path.string(),
             error && error.value() != ENOENT ? error.message() : "no such file");
    }
    if (std::filesystem::is_directory(status)) {
        fail(ExitCode::invalid_input, "{}: cannot read (got a folder; expected a file)", path.string());
    }
    if (!std::filesystem::is_regular_file(status)) {
        fail(ExitCode::invalid_input, "{}: cannot read (got a device or pipe; expected a file)",
             path.string());
    }
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) fail(ExitCode::invalid_input, "{}: cannot read ({})", path.string(), error.message());
    return bytes;
}

std::string read_text_file(const std::filesystem::path& path, std::uintmax_t largest_bytes) {
    const std::uintmax_t bytes = check_regular_file(path);
    if (bytes > largest_bytes) {
        fail(ExitCode::invalid_input, "{}: too large (got {} bytes; expected at most {})", path.string(),
             bytes, largest_bytes);
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) fail(ExitCode::invalid_input, "{}: cannot read ({})", path.string(), std::strerror(errno));
    std::string text(static_cast<std::size_t>(bytes), '\0');
    if (!file.read(text.data(), static_cast<std::streamsize>(bytes)))
        fail(ExitCode::invalid_input, "{}: cannot read", path.string());
    return text;
}

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

}  // namespace postlens
