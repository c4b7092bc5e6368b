// Replaces the global operator new and delete of a program: large blocks get pages of 2 MB instead of 4 KB.
// Linux gives such pages only where it is asked to (transparent huge pages, setting `madvise`, the default of
// Debian). A picture of 1920x1080 in memory is then a hundred page faults instead of fifty thousand, and misses
// of the address cache (TLB) become rare. Blocks still come from malloc, so that memory may also be freed by
// code that was compiled without these functions.
//
// This file is no part of the library, because a library must not decide how a program allocates memory. core/CMakeLists.txt
// adds it to programs.
#include <cstddef>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace {

/// Size of a huge page on x86-64 and on ARM with pages of 4 KB. A smaller block cannot contain one.
constexpr std::size_t huge_page_bytes = std::size_t{1} << 21;

void* allocate(std::size_t bytes) {
    if (bytes < huge_page_bytes) return std::malloc(bytes > 0 ? bytes : 1);
    void* block = nullptr;
    if (::posix_memalign(&block, huge_page_bytes, bytes) != 0) return nullptr;
#ifdef MADV_HUGEPAGE
    // A hint. Where the kernel refuses it, the block has small pages.
    static_cast<void>(::madvise(block, bytes, MADV_HUGEPAGE));
#endif
    return block;
}

}  // namespace

// The other forms of new and delete (arrays, sized, nothrow) call these two.
void* operator new(std::size_t bytes) {
    for (;;) {
        if (void* block = allocate(bytes)) return block;
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr) throw std::bad_alloc();
        handler();
    }
}

void operator delete(void* block) noexcept {
    std::free(block);
}

void operator delete(void* block, std::size_t /*bytes*/) noexcept {
    std::free(block);
}
