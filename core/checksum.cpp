#include "core/checksum.h"

#include <fmt/format.h>

// Compiles the functions of xxHash into this file, so that programs need not link its library.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace postlens {

struct Checksum::State {
    XXH3_state_t hash{};
    State() { XXH3_64bits_reset(&hash); }
};

Checksum::Checksum() : state_(std::make_unique<State>()) {}
Checksum::~Checksum() = default;
Checksum::Checksum(Checksum&&) noexcept = default;
Checksum& Checksum::operator=(Checksum&&) noexcept = default;

void Checksum::add(const void* bytes, std::size_t count) {
    XXH3_64bits_update(&state_->hash, bytes, count);
}

std::uint64_t Checksum::value() const {
    return XXH3_64bits_digest(&state_->hash);
}

std::uint64_t checksum_of(const void* bytes, std::size_t count) {
    return XXH3_64bits(bytes, count);
}

std::string checksum_text(std::uint64_t checksum) {
    return fmt::format("{:016x}", checksum);
}

}  // namespace postlens
