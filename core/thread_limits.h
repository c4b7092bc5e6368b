// Checks how many threads the system allows.
#pragma once

namespace postlens {

/// Throws Error(out_of_memory) unless the system allows `number` more threads. It starts and ends them as a
/// test, because TBB would abort the process or wait forever without them.
void require_threads(int number);

/// Number of threads that a library for image files may start, in addition to the threads of postlens (see
/// Job).
[[nodiscard]] int library_threads();

/// Number of threads that log4cplus (used by Debian's OpenImageIO) starts when the picture module is loaded.
/// If they cannot be started, the loader waits forever or aborts the process.
inline constexpr int picture_module_threads = 4;

}  // namespace postlens
