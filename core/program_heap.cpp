// Makes the heaps of a program grow by 64 MB at a time instead of glibc's 128 KB. core/operator_new.cpp
// requests huge pages for this memory. The kernel provides a huge page only if all of its addresses belong to
// the heap before the first of them is written to.
//
// Memory that is never written to costs nothing. This file is not part of the library, because its settings
// affect the whole process. core/CMakeLists.txt adds it to programs, but not to the Python module.
#include <malloc.h>

namespace {

[[maybe_unused]] const bool heaps_grow_far = [] {
#ifdef __GLIBC__
    constexpr int MB = 1 << 20;
    // 64 MB is the size of a thread's heap, and 32 MB the largest threshold that glibc allows. A thread's
    // heap then keeps its memory, so huge pages need not be requested again.
    mallopt(M_TOP_PAD, 64 * MB);
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // By default, glibc returns unused memory at the end of the main heap, and its huge pages, once it
    // exceeds 128 KB.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
