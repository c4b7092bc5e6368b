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
    // The largest values that glibc allows. With them, a thread's heap keeps its memory instead of returning
    // it to the system, so huge pages need not be requested again.
    mallopt(M_TOP_PAD, 64 * MB);
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // By default, glibc returns unused memory at the end of the heap as soon as it exceeds 128 KB.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
