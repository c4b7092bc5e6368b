// Threads of the OpenEXR library.
#pragma once

namespace postlens {

/// Starts the OpenEXR library's thread pool, which all files share, if it is not running. Returns the number
/// of threads. Without this pool, the library uses only the calling thread.
/// A forked child process has no such threads, and must not read files with them.
int exr_library_threads();

}  // namespace postlens
