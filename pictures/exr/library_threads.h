// Threads of the OpenEXR library.
#pragma once

namespace postlens {

/// Number of threads with which the OpenEXR library decompresses a file. The first call starts them; by
/// default, the library uses the calling thread only.
int exr_library_threads();

}  // namespace postlens
