// Checks how many threads the system allows.
#pragma once

namespace postlens {

/// Throws Error(out_of_memory) unless the system allows `number` more threads. The function starts this many
/// threads and ends them again. Without this check, TBB would abort the process or wait forever if it could
/// not start a thread later.
void require_threads(int number);

/// Number of threads that a library for image files may start in addition to the threads of the jobs.
[[nodiscard]] int library_threads();

/// Number of threads that log4cplus, a library on which Debian's OpenImageIO depends, starts when the picture
/// module is loaded. If they cannot be started, the loader waits forever or aborts the process.
inline constexpr int picture_module_threads = 4;

}  // namespace postlens
