// Makes the heaps of a program grow by 64 MB at a time instead of glibc's 128 KB. Memory gets a huge page
// (core/operator_new.cpp) only if the heap contains the whole page before the first write to it. Reserved
// memory costs nothing until it is written to.
//
// This file is not part of the library, because its settings affect the whole process.
#include <malloc.h>

namespace {

[[maybe_unused]] const bool heaps_grow_far = [] {
#ifdef __GLIBC__
    constexpr int MB = 1 << 20;
    // glibc then keeps all unused memory of a thread's heap (at most 64 MB). 32 MB is the largest threshold
    // that glibc allows.
    mallopt(M_TOP_PAD, 64 * MB);
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // Keeps up to 256 MB of unused memory at the end of the main heap. By default, glibc returns more than
    // 128 KB to the system, and the program loses the huge pages of this memory.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
