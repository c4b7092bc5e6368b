#include "core/memory.h"

#include <fstream>
#include <limits>
#include <sys/resource.h>

#include "core/error.h"

#ifdef __GLIBC__  // defined by the headers above
#include <malloc.h>
#endif

namespace postlens {

std::uint64_t available_memory_bytes() {
    std::ifstream file("/proc/meminfo");
    std::string word;
    while (file >> word) {
        std::uint64_t kilobytes = 0;
        if (word == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
    }
    return std::numeric_limits<std::uint64_t>::max();
}

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void require_memory(std::uint64_t bytes, const std::string& what) {
    const std::uint64_t free = available_memory_bytes();
    if (bytes <= free) return;
    fail(ExitCode::out_of_memory, "{} needs {} MB of memory ({} MB are free)", what, bytes / 1'000'000,
         free / 1'000'000);
}

void give_back_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

}  // namespace postlens
