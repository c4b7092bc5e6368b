// Replaces the global operator new and delete of a program, so that large blocks get pages of 2 MB instead of
// 4 KB. This avoids page faults and misses of the address cache (TLB).
//
// Blocks still come from malloc, so code that was compiled without these functions may free them. This file
// is not part of the library, because a library must not decide how a program allocates memory.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace {

/// Size of a huge page on x86-64, and on ARM with ordinary pages of 4 KB.
constexpr std::uintptr_t huge_page_bytes = std::uintptr_t{1} << 21;

/// Requests huge pages for the addresses from begin to end, both multiples of the size of a huge page. Errors
/// are ignored: addresses that are refused keep small pages.
void request_huge_pages(std::uintptr_t begin, std::uintptr_t end) {
#ifdef MADV_HUGEPAGE
    // NOLINTNEXTLINE(performance-no-int-to-ptr): only the kernel uses this pointer
    if (begin < end) static_cast<void>(::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
#endif
}

#ifdef POSTLENS_OWN_HEAPS
/// Number of huge pages in the address space, each of 2^21 bytes. The addresses of a program have 47 bits
/// (x86-64) or 48 bits (ARM), so 48 bits are assumed.
constexpr std::size_t huge_pages = std::size_t{1} << (48 - 21);

/// Contains one bit for each huge page of the address space. The bit is set when request_what_follows has
/// asked the kernel to use huge pages from this page on, so that the request is not repeated. The array takes
/// hardly any memory, because most of it is never written to.
std::array<std::atomic<std::uint64_t>, huge_pages / 64> reached;

/// Asks the kernel for huge pages at the addresses after a block of memory, which ends at `block_end`. malloc
/// will place the next blocks there. The size of a page is decided when it is first written to. Therefore,
/// the request must be made before these blocks are used.
void request_what_follows(std::uintptr_t block_end) {
    constexpr std::uintptr_t pages_ahead = 8;
    const std::uintptr_t page = block_end / huge_page_bytes;
    std::atomic<std::uint64_t>& bits = reached[page % huge_pages / 64];
    const std::uint64_t bit = std::uint64_t{1} << (page % 64);
    if ((bits.load(std::memory_order_relaxed) & bit) != 0) return;
    bits.fetch_or(bit, std::memory_order_relaxed);
    request_huge_pages(page * huge_page_bytes, (page + 1 + pages_ahead) * huge_page_bytes);
}
#else
/// Does nothing. This version is for a module that another program loads, such as the Python module of
/// postlens. The memory after an allocated block may then belong to the other program, so its pages must not
/// be changed.
void request_what_follows(std::uintptr_t /*block_end*/) {}
#endif

}  // namespace

// Replaces the global operator new. Its array forms and std::nothrow forms call this function. The forms for
// over-aligned types are not replaced.
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
