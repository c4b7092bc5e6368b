// Replaces the global operator new and delete of a program, so that its memory has pages of 2 MB instead of
// 4 KB. By default Debian's kernel gives such pages only on request (transparent huge pages, setting
// `madvise`). With small pages, the first use of 100 MB causes 25,000 page faults, and misses of the address
// cache (TLB) are frequent.
//
// Blocks still come from malloc. Memory may therefore be freed by code that was compiled without these
// functions. The kernel keeps the request for these addresses after a block is freed.
//
// This file is not part of the library, because a library must not decide how a program allocates memory.
// core/CMakeLists.txt adds it to programs.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace {

/// Size of a huge page on x86-64, and on ARM with pages of 4 KB.
constexpr std::uintptr_t huge_page_bytes = std::uintptr_t{1} << 21;

/// Requests huge pages for the addresses from begin to end, multiples of the size of such a page. If the
/// kernel refuses, they keep small pages. Parts that are not in use cause an error after the others have been
/// marked.
void request_huge_pages(std::uintptr_t begin, std::uintptr_t end) {
#ifdef MADV_HUGEPAGE
    if (begin < end) static_cast<void>(::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
#endif
}

/// Addresses have 47 bits (x86-64) or 48 (ARM).
constexpr std::size_t huge_pages = std::size_t{1} << (48 - 21);

/// A bit for each huge page in which a block has ended. Of these 16 MB only what is written to takes memory:
/// 4 KB for each 64 GB of addresses in use.
std::array<std::atomic<std::uint64_t>, huge_pages / 64> reached;

/// Requests huge pages for where the next blocks of a heap will be, once for each huge page in which a block
/// ends. This has to be ahead of them: malloc writes to the memory behind a block, after which the page
/// around it is small.
void request_what_follows(std::uintptr_t block_end) {
    constexpr std::uintptr_t pages_ahead = 8;
    const std::uintptr_t page = block_end / huge_page_bytes;
    std::atomic<std::uint64_t>& bits = reached[page % huge_pages / 64];
    const std::uint64_t bit = std::uint64_t{1} << (page % 64);
    if ((bits.load(std::memory_order_relaxed) & bit) != 0) return;
    bits.fetch_or(bit, std::memory_order_relaxed);
    request_huge_pages(page * huge_page_bytes, (page + 1 + pages_ahead) * huge_page_bytes);
}

}  // namespace

// The forms for arrays and with std::nothrow call these functions. The forms for over-aligned types are not
// replaced.
void* operator new(std::size_t bytes) {
    for (;;) {
        if (void* block = std::malloc(bytes > 0 ? bytes : 1)) {
            const auto begin = reinterpret_cast<std::uintptr_t>(block), end = begin + bytes;
            request_huge_pages((begin + huge_page_bytes - 1) / huge_page_bytes * huge_page_bytes,
                               end / huge_page_bytes * huge_page_bytes);
            request_what_follows(end);
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
