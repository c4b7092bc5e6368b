// Threads of the OpenEXR library.
#pragma once

namespace postlens {

/// Starts the thread pool of the OpenEXR library, which all files share, unless it is already running.
/// Returns the number of threads. Without this pool, the library uses only the calling thread. A child
/// process (after fork without exec) does not have the threads and must not use them to read files.
int exr_library_threads();

}  // namespace postlens
