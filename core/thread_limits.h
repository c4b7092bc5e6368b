// Checks how many threads the system allows.
#pragma once

namespace postlens {

/// Throws Error(out_of_memory) unless the system allows `number` more threads. As a test, it starts and ends
/// this number of threads. The test is needed because TBB would abort the process or wait forever if it could
/// not start its threads.
void require_threads(int number);

/// Returns how many threads a library that reads or writes image files (such as OpenEXR) may start for its
/// own work. These threads come in addition to the threads that postlens itself uses (see Job).
[[nodiscard]] int library_threads();

/// Number of threads that are started when the picture module of postlens is loaded. It uses OpenImageIO,
/// which in Debian uses log4cplus, and this library starts them. If they cannot be started, the loader waits
/// forever or aborts the process. Therefore, require_threads() first tests that they can be.
inline constexpr int picture_module_threads = 4;

}  // namespace postlens
