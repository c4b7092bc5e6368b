// SHA-256 of what a scene was read from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace postlens {

/// A running SHA-256.
class Sha256 {
  public:
    Sha256();
    ~Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;
    Sha256(Sha256&&) = delete;
    Sha256& operator=(Sha256&&) = delete;

    void add(std::string_view bytes);
    /// 64 lower-case hexadecimal digits. Call once.
    [[nodiscard]] std::string hex();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Throws Error(invalid_input) "FILE: ..." unless the path is a readable regular file; returns its size in
/// bytes.
std::uintmax_t check_regular_file(const std::filesystem::path& path);

/// The whole file as text. Throws Error(invalid_input) as above and where it is larger than `largest_bytes`.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path, std::uintmax_t largest_bytes);

/// Of the file's bytes. Throws Error(invalid_input).
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace postlens
