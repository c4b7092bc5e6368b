// Runs another program and waits for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace postlens {

struct ChildResult {
    int exit_code = 0;  ///< 127: could not be started; 128: ended by a signal
    double seconds = 0;
    std::uint64_t peak_memory_bytes = 0;
};

/// Runs `words[0]`, which is looked for in PATH, with the other words as its arguments. It reads nothing;
/// what it writes goes to `output`, or is lost. An interruption ends it, and throws Error(interrupted).
ChildResult run_child(const std::vector<std::string>& words, const std::filesystem::path& output = {});

}  // namespace postlens
