#include "pictures/exr/library_threads.h"

#include <OpenEXR/ImfThreading.h>
#include <mutex>
#include <thread>

namespace postlens {

int exr_library_threads() {
    static std::once_flag once;
    std::call_once(once,
                   [] { Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency())); });
    return Imf::globalThreadCount();
}

}  // namespace postlens
