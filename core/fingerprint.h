// A 64-bit hash of settings. Different settings almost always have different hashes.
#pragma once

#include <bit>
#include <cstdint>

namespace postlens {

/// FNV-1a hash of the bytes of all added values, in the order in which they are added.
class Fingerprint {
  public:
    void add(std::uint64_t bits) {
        for (int shift = 0; shift < 64; shift += 8)
            hash_ = (hash_ ^ ((bits >> shift) & 0xFFU)) * 0x100000001b3U;
    }
    void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

  private:
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace postlens
