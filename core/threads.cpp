#include "core/threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_group.h>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/job.h"

namespace postlens {

#if defined(__SANITIZE_THREAD__)

// This version for ThreadSanitizer uses plain threads, each with a fixed part of the chunks. ThreadSanitizer
// cannot see the synchronisation inside TBB, and would report every loop as a race.
void parallel_chunks(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& chunk) {
    const std::size_t chunks = count / grain + (count % grain != 0 ? 1 : 0);
    const auto thread_number = static_cast<std::size_t>(thread_count());
    std::atomic<bool> failed{false};
    std::exception_ptr error;
    Job& job = Job::current();
    const auto work = [&](std::size_t first_chunk) {
        const JobScope scope(job);
        for (std::size_t c = first_chunk; c < chunks; c += thread_number) {
            // This read is relaxed on purpose. With a stronger memory order, it would synchronise the
            // threads. ThreadSanitizer would then regard accesses in different threads as ordered, and would
            // miss races between them.
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

void run_overlapped(std::size_t count, std::size_t /*ahead*/, const std::function<void(std::size_t)>& make,
                    const std::function<void(std::size_t)>& end) {
    run_in_order(count, 1, make, end);
}

#else

namespace {

void run_pipeline(std::size_t count, std::size_t at_a_time, tbb::filter_mode make_mode,
                  const std::function<void(std::size_t)>& make, const std::function<void(std::size_t)>& end) {
    Job& job = Job::current();
    std::size_t next = 0;
    const auto begin_one = [&](tbb::flow_control& control) {
        const JobScope scope(job);
        if (next == count) {
            control.stop();
            return count;
        }
        throw_if_interrupted();
        return next++;
    };
    const auto make_one = [&](std::size_t i) {
        const JobScope scope(job);
        make(i);
        return i;
    };
    const auto end_one = [&](std::size_t i) {
        const JobScope scope(job);
        end(i);
    };
    using tbb::filter_mode;
    job.run([&] {
        tbb::parallel_pipeline(
            at_a_time, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, begin_one) &
                           tbb::make_filter<std::size_t, std::size_t>(make_mode, make_one) &
                           tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, end_one));
    });
}

}  // namespace

void parallel_chunks(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& chunk) {
    Job& job = Job::current();
    job.run([&] {
        tbb::task_group_context context;
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, grain),
            [&](const tbb::blocked_range<std::size_t>& range) {
                const JobScope scope(job);
                // Checks for cancellation before every `grain` indices. One check per range would not
                // suffice, because the ranges that TBB chooses may be many times longer than `grain`.
                for (std::size_t begin = range.begin(); begin != range.end();) {
                    throw_if_interrupted();
                    const std::size_t end = begin + std::min(grain, range.end() - begin);
                    chunk(begin, end);
                    begin = end;
                }
            },
            context);
        // Throws an error if an outer loop, in which this loop runs, has failed. TBB has then cancelled this
        // loop too, but reports no error here, so the caller would use incomplete results. The user sees only
        // the error of the outer loop.
        if (context.is_group_execution_cancelled()) fail(ExitCode::interrupted, "an outer loop has failed");
    });
}

void run_in_order(std::size_t count, std::size_t at_a_time, const std::function<void(std::size_t)>& make,
                  const std::function<void(std::size_t)>& end) {
    run_pipeline(count, at_a_time, tbb::filter_mode::parallel, make, end);
}

void run_overlapped(std::size_t count, std::size_t ahead, const std::function<void(std::size_t)>& make,
                    const std::function<void(std::size_t)>& end) {
    run_pipeline(count, ahead + 1, tbb::filter_mode::serial_in_order, make, end);
}

#endif

}  // namespace postlens
