// Few seconds and little memory for a command, with and without sanitizers.
#pragma once

#include <string>
#include <sys/resource.h>

namespace postlens::test {

/// What stands before a line of shell so that its command has 10 s (124 is timeout's word for too long) and 1
/// GiB. Sanitizers take address space far beyond what they use: with them it is the resident memory that is
/// limited, by AddressSanitizer itself, and there are 30 s.
inline std::string ten_seconds_and_a_gibibyte() {
#if defined(__SANITIZE_ADDRESS__)
    return "ASAN_OPTIONS=\"${ASAN_OPTIONS:+$ASAN_OPTIONS:}quarantine_size_mb=64:hard_rss_limit_mb=1024\" "
           "timeout 30 ";
#elif defined(__SANITIZE_THREAD__)
    return "timeout 30 ";
#else
    return "ulimit -v 1048576; timeout 10 ";
#endif
}

/// The most memory that any command run so far has held, kB.
inline long most_kilobytes_of_commands() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    return usage.ru_maxrss;
}

}  // namespace postlens::test
