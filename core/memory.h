// Asking for memory before taking it: a request that cannot be met ends in one line instead of a killed
// process.
#pragma once

#include <cstdint>
#include <string>

namespace postlens {

/// What the system says is free for programs, bytes; the largest number where it says nothing.
[[nodiscard]] std::uint64_t available_memory_bytes();

/// The most memory that this process has held at once so far, bytes (its peak resident set).
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// Throws Error(out_of_memory) "WHAT needs N MB of memory (M MB are free)" where `bytes` are not to be had.
void require_memory(std::uint64_t bytes, const std::string& what);

/// Gives memory that was freed and is kept for what may come back to the system, where the C library can.
/// For work in parts of which each takes much, in pieces of other sizes than the one before.
void give_back_memory();

}  // namespace postlens
