#include "pictures/exr/library_threads.h"

#include <OpenEXR/ImfThreading.h>
#include <algorithm>
#include <mutex>
#include <thread>

namespace postlens {

int exr_library_threads() {
    // More are hardly busy, and a limit of memory or processes may forbid to start them.
    constexpr int most = 8;
    static std::once_flag once;
    std::call_once(once, [&] {
        Imf::setGlobalThreadCount(std::min(static_cast<int>(std::thread::hardware_concurrency()), most));
    });
    return Imf::globalThreadCount();
}

}  // namespace postlens
