// Threads of the OpenEXR library.
#pragma once

namespace postlens {

/// Starts the threads that the OpenEXR library shares among all files, unless they are already running.
/// Returns their number. By default, the library uses only the calling thread. A process that is forked
/// afterwards (without exec) must not use these threads to read files.
int exr_library_threads();

}  // namespace postlens
