// Limits of the system on the number of threads.
#pragma once

namespace postlens {

/// Throws Error(out_of_memory) unless the system allows `number` more threads. Tests this by starting and
/// ending them: if TBB could not start a thread later, it would abort the process or wait forever.
void require_threads(int number);

/// Number of threads that a library for files may keep beside those of the jobs.
[[nodiscard]] int library_threads();

/// Number of threads that the picture module starts while it is loaded: those of log4cplus, on which Debian's
/// OpenImageIO depends. If they cannot be started, the loader waits forever or aborts the process.
inline constexpr int picture_module_threads = 4;

}  // namespace postlens
