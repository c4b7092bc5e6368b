// Replaces the global operator new and delete of a program, so that large blocks of memory get pages of 2 MB
// instead of 4 KB. By default Debian's kernel gives such pages only on request (transparent huge pages,
// setting `madvise`). With small pages, the first use of 100 MB causes 25,000 page faults, and misses of the
// address cache (TLB) are frequent.
//
// Blocks still come from malloc. Memory may therefore be freed by code that was compiled without these
// functions. The kernel keeps the request for these addresses after a block is freed, so later small blocks
// there have large pages, too.
//
// This file is not part of the library, because a library must not decide how a program allocates memory.
// core/CMakeLists.txt adds it to programs.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace {

/// Size of a huge page on x86-64, and on ARM with pages of 4 KB.
constexpr std::uintptr_t huge_page_bytes = std::uintptr_t{1} << 21;

/// Requests huge pages for the part of a block that consists of whole pages.
void request_huge_pages(void* block, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    const auto address = reinterpret_cast<std::uintptr_t>(block);
    const std::uintptr_t begin = (address + huge_page_bytes - 1) / huge_page_bytes * huge_page_bytes;
    const std::uintptr_t end = (address + bytes) / huge_page_bytes * huge_page_bytes;
    // If the kernel refuses, the block keeps small pages.
    if (begin < end)
        static_cast<void>(
            ::madvise(static_cast<char*>(block) + (begin - address), end - begin, MADV_HUGEPAGE));
#endif
}

}  // namespace

// The forms for arrays and with std::nothrow call these functions. The forms for over-aligned types are not
// replaced.
void* operator new(std::size_t bytes) {
    for (;;) {
        if (void* block = std::malloc(bytes > 0 ? bytes : 1)) {
            if (bytes >= huge_page_bytes) request_huge_pages(block, bytes);
            return block;
        }
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
