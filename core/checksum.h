// Checksums that detect changed or damaged files, rows and images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace postlens {

/// XXH3 hash (64 bit, seed 0) of bytes that are added in pieces. How the bytes are divided into pieces does
/// not matter.
class Checksum {
  public:
    Checksum();
    ~Checksum();
    Checksum(const Checksum&) = delete;
    Checksum& operator=(const Checksum&) = delete;
    Checksum(Checksum&&) noexcept;
    Checksum& operator=(Checksum&&) noexcept;

    void add(const void* bytes, std::size_t count);
    /// Hash of all bytes added so far.
    [[nodiscard]] std::uint64_t value() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Returns the hash that Checksum computes for the same bytes.
[[nodiscard]] std::uint64_t checksum_of(const void* bytes, std::size_t count);

/// Returns the checksum as 16 hexadecimal digits, as text files and image attributes store it.
[[nodiscard]] std::string checksum_text(std::uint64_t checksum);

}  // namespace postlens
