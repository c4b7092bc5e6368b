// Limits of the system on the number of threads.
#pragma once

#include <string>
#include <system_error>

namespace postlens {

/// Throws Error(out_of_memory) unless `number` threads can exist beside those that exist. They are started
/// and ended, because TBB aborts the process, or waits forever, if it cannot start a thread later.
void require_threads(int number);

/// The message of an error in starting a thread.
[[nodiscard]] std::string thread_error_text(const std::system_error& error);

/// Number of threads that a library for files may keep beside those of the jobs.
[[nodiscard]] int library_threads();

}  // namespace postlens
