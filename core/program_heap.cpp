// Makes the heaps of a program grow by 64 MB at a time instead of glibc's 128 KB. core/operator_new.cpp
// requests huge pages for this memory. The kernel provides a huge page only if the heap already covers all of
// its addresses when the first one is written to.
//
// Memory that is never written to costs nothing. This file is not part of the library, because its settings
// affect the whole process. core/CMakeLists.txt adds it to programs, but not to the Python module.
#include <malloc.h>

namespace {

[[maybe_unused]] const bool heaps_grow_far = [] {
#ifdef __GLIBC__
    constexpr int MB = 1 << 20;
    // These are the largest values that glibc allows. A thread's heap has 64 MB, and a larger block has its
    // own mapping. A thread's heap then never returns memory to the system, so its huge pages need not be
    // requested again.
    mallopt(M_TOP_PAD, 64 * MB);
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // By default, glibc returns unused memory at the end of the heap as soon as it exceeds 128 KB.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
