// Checks how many threads the system allows.
#pragma once

namespace postlens {

/// Throws Error(out_of_memory) unless the system allows `number` more threads. It starts and ends them as a
/// test, because TBB would abort the process or wait forever without them.
void require_threads(int number);

/// Returns how many threads a library that reads or writes image files (such as OpenEXR) may start for its
/// own work. These threads come in addition to the threads that postlens itself uses (see Job).
[[nodiscard]] int library_threads();

/// The picture module of postlens uses OpenImageIO. In Debian, OpenImageIO uses the library log4cplus, which
/// starts this number of threads when the module is loaded. If they cannot be started, the loader waits
/// forever or aborts the process. Therefore, require_threads() checks this before the module is loaded.
inline constexpr int picture_module_threads = 4;

}  // namespace postlens
