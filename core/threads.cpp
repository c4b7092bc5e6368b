#include "core/threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <thread>
#include <vector>

#include "core/progress.h"

namespace postlens {

struct ThreadLimit::Impl {
    Impl(int thread_number, Impl* outer_limit)
        : threads(thread_number), arena(thread_number), outer(outer_limit) {}

    int threads;
    tbb::task_arena arena;
    Impl* outer;
    /// An arena alone gets no more threads than there are cores, so the limit is set for all of TBB as well.
    /// TBB takes the lowest of all controls alive: only the innermost limit may hold one.
    std::optional<tbb::global_control> control;

    void hold() {
        control.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    }
};

ThreadLimit::Impl* ThreadLimit::innermost = nullptr;

ThreadLimit::ThreadLimit(int threads)
    : impl_(std::make_unique<Impl>(threads > 0 ? threads : tbb::info::default_concurrency(), innermost)) {
    if (impl_->outer != nullptr) impl_->outer->control.reset();
    impl_->hold();
    innermost = impl_.get();
}

ThreadLimit::~ThreadLimit() {
    impl_->control.reset();
    innermost = impl_->outer;
    if (innermost != nullptr) innermost->hold();
}

int thread_count() {
    return ThreadLimit::innermost != nullptr ? ThreadLimit::innermost->threads
                                             : tbb::info::default_concurrency();
}

tbb::task_arena* current_arena() {
    return ThreadLimit::innermost != nullptr ? &ThreadLimit::innermost->arena : nullptr;
}

#if defined(__SANITIZE_THREAD__)

// ThreadSanitizer does not see how TBB, which is not built for it, orders its tasks, and reports every loop
// as a race. Plain threads, each with its fixed share of the chunks and no order between them, are what it
// understands.
void parallel_chunks(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& chunk) {
    const std::size_t chunks = count / grain + (count % grain != 0 ? 1 : 0);
    const auto thread_number = static_cast<std::size_t>(thread_count());
    std::atomic<bool> failed{false};
    std::exception_ptr error;
    const auto work = [&](std::size_t first_chunk) {
        for (std::size_t c = first_chunk; c < chunks; c += thread_number) {
            // Relaxed: an order between chunks would hide races between them.
            if (failed.load(std::memory_order_relaxed)) return;
            try {
                throw_if_interrupted();
                chunk(c * grain, c * grain + std::min(grain, count - c * grain));
            } catch (...) {
                if (!failed.exchange(true)) error = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 1; i < thread_number; ++i) threads.emplace_back(work, i);
        work(0);
    }
    if (error) std::rethrow_exception(error);
}

void run_in_order(std::size_t count, std::size_t /*at_a_time*/, const std::function<void(std::size_t)>& make,
                  const std::function<void(std::size_t)>& end) {
    for (std::size_t i = 0; i < count; ++i) {
        throw_if_interrupted();
        make(i);
        end(i);
    }
}

#else

namespace {

template <typename Work>
void in_current_arena(const Work& work) {
    if (tbb::task_arena* arena = current_arena()) {
        arena->execute(work);
    } else {
        work();
    }
}

}  // namespace

void parallel_chunks(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& chunk) {
    const auto loop = [&] {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              // TBB hands out ranges of many grains; a check per range would come too seldom.
                              for (std::size_t begin = range.begin(); begin != range.end();) {
                                  throw_if_interrupted();
                                  const std::size_t end = begin + std::min(grain, range.end() - begin);
                                  chunk(begin, end);
                                  begin = end;
                              }
                          });
    };
    in_current_arena(loop);
}

void run_in_order(std::size_t count, std::size_t at_a_time, const std::function<void(std::size_t)>& make,
                  const std::function<void(std::size_t)>& end) {
    std::size_t next = 0;
    const auto begin_one = [&](tbb::flow_control& control) {
        if (next == count) {
            control.stop();
            return count;
        }
        throw_if_interrupted();
        return next++;
    };
    const auto make_one = [&](std::size_t i) {
        make(i);
        return i;
    };
    using tbb::filter_mode;
    in_current_arena([&] {
        tbb::parallel_pipeline(
            at_a_time, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, begin_one) &
                           tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, make_one) &
                           tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, end));
    });
}

#endif

}  // namespace postlens
