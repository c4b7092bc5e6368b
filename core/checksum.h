// Checksums, by which a changed or damaged file, row or image is noticed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace postlens {

/// XXH3 hash (64 bit, seed 0) of bytes that are added in pieces. It does not depend on how the bytes are
/// divided.
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

/// The hash that Checksum computes, of bytes that are all in memory.
[[nodiscard]] std::uint64_t checksum_of(const void* bytes, std::size_t count);

/// 16 hexadecimal digits, the form in which text files and attributes store a checksum.
[[nodiscard]] std::string checksum_text(std::uint64_t checksum);

}  // namespace postlens
