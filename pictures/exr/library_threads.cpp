#include "pictures/exr/library_threads.h"

#include <OpenEXR/ImfThreading.h>
#include <mutex>

#include "core/thread_limits.h"

namespace postlens {

int exr_library_threads() {
    static std::once_flag once;
    std::call_once(once, [] { Imf::setGlobalThreadCount(library_threads()); });
    return Imf::globalThreadCount();
}

}  // namespace postlens
