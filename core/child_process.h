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

/// Runs the program `words[0]`, found in PATH, with the other words as its arguments. Its standard input is
/// empty; its output is written to the file `output`, or discarded if `output` is empty. If the current job
/// is cancelled, ends the program and throws Error(interrupted).
ChildResult run_child(const std::vector<std::string>& words, const std::filesystem::path& output = {});

}  // namespace postlens
