// Makes the heaps of the program grow by 64 MB at a time, instead of glibc's 128 KB, because
// core/operator_new.cpp requests huge pages (2 MB each). The kernel provides a huge page only if the heap
// already contains the whole page when it is first written to. Memory that is reserved in advance costs
// nothing until it is written to.
#include <malloc.h>

namespace {

[[maybe_unused]] const bool heaps_grow_far = [] {
#ifdef __GLIBC__
    constexpr int MB = 1 << 20;
    mallopt(M_TOP_PAD, 64 * MB);
    // Blocks of 32 MB or more do not come from a heap. Each of them gets a memory mapping of its own. glibc
    // allows no larger threshold.
    mallopt(M_MMAP_THRESHOLD, 32 * MB);
    // Keeps up to 256 MB of unused memory at the end of the main heap, so that the program can use it again.
    // By default, glibc returns all unused memory above 128 KB to the operating system, and the program loses
    // the huge pages of this memory.
    mallopt(M_TRIM_THRESHOLD, 256 * MB);
#endif
    return true;
}();

}  // namespace
