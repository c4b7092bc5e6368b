// Makes the heaps of a program grow by 64 MB at a time, so that their memory can have the huge pages that
// core/operator_new.cpp requests: the kernel gives a huge page only if all of its addresses are in use when
// the first of them is written to. By default, glibc extends a heap by 128 KB.
//
// Memory that is never written to takes none. This file is not part of the library, because these settings
// are the whole process's. core/CMakeLists.txt adds it to programs, and not to the Python module.
#include <malloc.h>

namespace {

[[maybe_unused]] const bool heaps_grow_far = [] {
#ifdef __GLIBC__
    constexpr int MB = 1 << 20;
    // The most that glibc allows: a thread's heap has 64 MB, and a larger block has a mapping of its own.
    // With this step, heaps of threads are never given back, whose huge pages would have to be requested
    // again.
    mallopt(M_TOP_PAD, 64 * MB);
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // By default, glibc gives unused memory at the end of the heap back from 128 KB on.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
