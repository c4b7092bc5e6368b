// Runs another program and waits for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace postlens {

struct ChildResult {
    int exit_code = 0;  ///< 127 if the program did not start, 128 if a signal ended it
    double seconds = 0;
    std::uint64_t peak_memory_bytes = 0;
};

/// Runs the program `words[0]`, which is searched for in PATH, with the other words as its arguments. Its
/// output is written to the file `output`, or discarded.
///
/// If the current job is cancelled, this function ends the program and throws Error(interrupted).
ChildResult run_child(const std::vector<std::string>& words, const std::filesystem::path& output = {});

}  // namespace postlens
