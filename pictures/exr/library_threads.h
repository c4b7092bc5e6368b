// Threads of the OpenEXR library.
#pragma once

namespace postlens {

/// Starts the thread pool of the OpenEXR library, which all files share, and returns its number of threads.
/// Without it, the library uses only the calling thread. A forked child process has no such threads, and must
/// not read files with them.
int exr_library_threads();

}  // namespace postlens
