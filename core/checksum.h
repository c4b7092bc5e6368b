// Checksums, by which a changed or damaged file, row or image is noticed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace postlens {

/// XXH3 (64 bit, seed 0) of bytes that come in pieces. How they are divided does not change it.
class Checksum {
  public:
    Checksum();
    ~Checksum();
    Checksum(const Checksum&) = delete;
    Checksum& operator=(const Checksum&) = delete;
    Checksum(Checksum&&) noexcept;
    Checksum& operator=(Checksum&&) noexcept;

    void add(const void* bytes, std::size_t count);
    /// Of everything added so far.
    [[nodiscard]] std::uint64_t value() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// As Checksum, of bytes that are all at hand.
[[nodiscard]] std::uint64_t checksum_of(const void* bytes, std::size_t count);

/// 16 hexadecimal digits, the form in which text files and attributes store a checksum.
[[nodiscard]] std::string checksum_text(std::uint64_t checksum);

}  // namespace postlens
