#include "core/thread_limits.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <pthread.h>
#include <thread>
#include <vector>

#include "core/error.h"

namespace postlens {

void require_threads(int number) {
    constexpr std::size_t stack_bytes = 4U << 20U;  // of a TBB thread
    std::atomic<bool> may_end{false};
    const auto wait = [](void* end) -> void* {
        static_cast<const std::atomic<bool>*>(end)->wait(false);
        return nullptr;
    };
    std::vector<pthread_t> threads;
    threads.reserve(static_cast<std::size_t>(number));
    pthread_attr_t attributes;
    int error = ::pthread_attr_init(&attributes);
    if (error == 0) error = ::pthread_attr_setstacksize(&attributes, stack_bytes);
    while (error == 0 && threads.size() < static_cast<std::size_t>(number)) {
        pthread_t thread{};
        error = ::pthread_create(&thread, &attributes, wait, &may_end);
        if (error == 0) threads.push_back(thread);
    }
    ::pthread_attr_destroy(&attributes);
    may_end = true;
    may_end.notify_all();
    for (const pthread_t thread : threads) ::pthread_join(thread, nullptr);
    if (error != 0) {
        fail(
            ExitCode::out_of_memory,
            "cannot start the threads (got {} beside those that run: {}; expected {}, by a higher limit such "
            "as ulimit -u, or fewer --threads)",
            threads.size(), std::strerror(error), number);
    }
}

int library_threads() {
    // Largest number of threads that a library for image files may start. With more threads, each would have
    // too little work to be useful. In addition, some threads might not start if the memory or the number of
    // processes is limited.
    constexpr int most = 8;
    return std::min(static_cast<int>(std::thread::hardware_concurrency()), most);
}

}  // namespace postlens
