// Makes the heaps of a program grow by 64 MB at a time instead of glibc's 128 KB. The kernel provides a huge
// page (core/operator_new.cpp) only for addresses that belong to the heap before the first write. Memory that
// is never written to costs nothing.
//
// This file is not part of the library, because its settings affect the whole process.
#include <malloc.h>

namespace {

[[maybe_unused]] const bool heaps_grow_far = [] {
#ifdef __GLIBC__
    constexpr int MB = 1 << 20;
    // 64 MB is the size of a thread's heap, 32 MB the largest threshold that glibc allows. Threads thus keep
    // unused memory, with its huge pages.
    mallopt(M_TOP_PAD, 64 * MB);
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // Keeps unused memory at the end of the main heap. By default, glibc returns more than 128 KB to the
    // system, with its huge pages.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
