// The number of threads, and parallel loops that give the same result for any number of them.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <memory>

#include "core/progress.h"

namespace postlens {

/// While it lives, postlens' parallel loops use `threads` threads (0: all the machine has).
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;
    ThreadLimit(ThreadLimit&&) = delete;
    ThreadLimit& operator=(ThreadLimit&&) = delete;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// How many threads parallel loops use now, at least 1.
[[nodiscard]] int thread_count();

/// The arena that `ThreadLimit` set up, or nullptr for the default one.
[[nodiscard]] tbb::task_arena* current_arena();

/// Calls body(i) for i in [0, count), in any order, each once. The work of one index must not depend on the
/// thread it runs on: that is what keeps results equal for any number of threads.
/// Stops early with Error(interrupted) when the user interrupts.
template <typename Body>
void parallel_for(std::size_t count, const Body& body, std::size_t grain = 1) {
    const auto loop = [&] {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
            throw_if_interrupted();
            for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
        });
    };
    if (tbb::task_arena* arena = current_arena()) {
        arena->execute(loop);
    } else {
        loop();
    }
}

}  // namespace postlens
