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

/// Of the file's bytes. Throws Error(invalid_input).
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace postlens
