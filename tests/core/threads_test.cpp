// Parallel loops, limits of threads, and results that are made in parallel and end in order.
#include "core/threads.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/job.h"
#include "tests/core/error_text.h"

namespace postlens::test::threads_test {
namespace {

TEST(ParallelFor, CallsEachIndexOnce) {
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        for (const std::size_t count : std::array<std::size_t, 6>{0, 1, 2, 7, 1000, 100003}) {
            for (const std::size_t grain : std::array<std::size_t, 5>{0, 1, 3, 1024, SIZE_MAX}) {
                std::vector<std::atomic<int>> calls(count);
                parallel_for(
                    count, [&](std::size_t i) { ++calls.at(i); }, grain);
                for (std::size_t i = 0; i < count; ++i) {
                    ASSERT_EQ(calls[i], 1)
                        << "index " << i << " of " << count << ", grain " << grain << ", threads " << threads;
                }
            }
        }
    }
}

TEST(ParallelFor, GivesTheSameBitsForAnyNumberOfThreads) {
    const auto run = [](int threads) {
        const ThreadLimit limit(threads);
        std::vector<double> result(5000);
        parallel_for(result.size(), [&](std::size_t i) {
            double sum = 0;
            for (int k = 1; k < 50; ++k) sum += std::sin(static_cast<double>(i) / k);
            result[i] = sum;
        });
        return result;
    };
    const std::vector<double> one = run(1);
    EXPECT_NE(one[1], one[2]);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(5), one);
}

TEST(ParallelFor, PassesExceptionsThroughAndCanBeUsedAgain) {
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(error_text(ExitCode::invalid_input,
                             [] {
                                 parallel_for(10000, [](std::size_t i) {
                                     if (i == 4321) fail(ExitCode::invalid_input, "scene.toml:{}: bad", i);
                                 });
                             }),
                  "scene.toml:4321: bad");
        std::atomic<int> calls{0};
        parallel_for(10, [&](std::size_t) { ++calls; });
        EXPECT_EQ(calls, 10);
    }
}

TEST(ParallelFor, MayStandInsideAnother) {
    const ThreadLimit limit(3);
    std::vector<std::atomic<int>> calls(40 * 30);
    parallel_for(40, [&](std::size_t y) { parallel_for(30, [&](std::size_t x) { ++calls[y * 30 + x]; }); });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
}

/// Number of threads that work in a loop at the same time. Each index waits, up to a time limit, until
/// `expected` threads have arrived.
std::size_t threads_seen(std::size_t expected) {
    std::mutex mutex;
    std::set<std::thread::id> seen;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    parallel_for(4 * expected, [&](std::size_t) {
        for (;;) {
            {
                const std::lock_guard lock(mutex);
                seen.insert(std::this_thread::get_id());
                if (seen.size() >= expected) return;
            }
            if (std::chrono::steady_clock::now() > deadline) return;
            std::this_thread::yield();
        }
    });
    return seen.size();
}

TEST(ThreadLimit, GivesAsManyThreadsAsAskedForAlsoBeyondTheCores) {
    const int machine = thread_count();
    EXPECT_GE(machine, 1);
    {
        const ThreadLimit limit(5);
        EXPECT_EQ(thread_count(), 5);
        EXPECT_EQ(threads_seen(5), 5U);
    }
    EXPECT_EQ(thread_count(), machine);
}

TEST(ThreadLimit, TheInnerOneHoldsWhileItLives) {
    const int machine = thread_count();
    const ThreadLimit outer(2);
    {
        const ThreadLimit inner(4);
        EXPECT_EQ(thread_count(), 4);
        EXPECT_EQ(threads_seen(4), 4U);
        {
            const ThreadLimit innermost(1);
            EXPECT_EQ(thread_count(), 1);
            EXPECT_EQ(threads_seen(1), 1U);
        }
        EXPECT_EQ(thread_count(), 4);
        EXPECT_EQ(threads_seen(4), 4U);
        const ThreadLimit all(0);
        EXPECT_EQ(thread_count(), machine);
    }
    EXPECT_EQ(thread_count(), 2);
    EXPECT_EQ(threads_seen(2), 2U);
}

TEST(MakeInOrder, EndsInOrderAndHasNoMoreThanItMayAtOnce) {
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        for (const std::size_t at_a_time : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}}) {
            std::atomic<int> begun{0}, ended{0}, most{0}, ending{0};
            std::vector<std::size_t> order;
            make_in_order(
                40, at_a_time,
                [&](std::size_t i) {
                    int now = ++begun - ended;
                    for (int known = most; known < now && !most.compare_exchange_weak(known, now);) {
                    }
                    // Nested loops: a thread that waits for one may take work of another.
                    std::atomic<std::size_t> sum{0};
                    parallel_for(50, [&](std::size_t k) { sum += k * i; });
                    return std::make_unique<std::size_t>(sum.load());
                },
                [&](std::size_t i, std::unique_ptr<std::size_t> made) {
                    EXPECT_EQ(++ending, 1);
                    EXPECT_EQ(*made, 1225 * i);
                    order.push_back(i);
                    ++ended;
                    --ending;
                });
            ASSERT_EQ(order.size(), 40U);
            EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
            EXPECT_LE(most, static_cast<int>(std::max<std::size_t>(at_a_time, 1)));
        }
    }
    make_in_order(
        0, 2, [](std::size_t i) { return i; }, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(MakeInOrder, PassesOnWhatIsThrownAndEndsNothingAfterIt) {
    for (const bool while_making : {true, false}) {
        std::vector<std::size_t> ended;
        EXPECT_THROW(make_in_order(
                         30, 2,
                         [&](std::size_t i) {
                             if (while_making && i == 7) throw std::runtime_error("seven");
                             return i;
                         },
                         [&](std::size_t i, std::size_t) {
                             if (!while_making && i == 7) throw std::runtime_error("seven");
                             ended.push_back(i);
                         }),
                     std::runtime_error);
        EXPECT_LE(ended.size(), 7U);
        EXPECT_TRUE(std::is_sorted(ended.begin(), ended.end()));
    }
}

TEST(RunOverlapped, MakesAndEndsInOrderAndRunsAheadNoFurtherThanAllowed) {
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        for (const std::size_t ahead : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
            std::atomic<std::size_t> made{0}, ended{0};
            std::atomic<int> making{0}, ending{0};
            run_overlapped(
                30, ahead,
                [&](std::size_t i) {
                    EXPECT_EQ(++making, 1);
                    EXPECT_EQ(i, made);
                    EXPECT_LE(i, ended + ahead);
                    parallel_for(20, [](std::size_t) {});
                    ++made;
                    --making;
                },
                [&](std::size_t i) {
                    EXPECT_EQ(++ending, 1);
                    EXPECT_EQ(i, ended);
                    EXPECT_LT(i, made);
                    parallel_for(20, [](std::size_t) {});
                    ++ended;
                    --ending;
                });
            EXPECT_EQ(ended, 30U);
        }
    }
}

// Only the job of the process, which has no TBB arena of its own, ends inner loops when an outer loop fails.
TEST(RunOverlapped, NothingGoesOnWithAPartOfALoop) {
    if (thread_count() < 2) GTEST_SKIP() << "needs two threads";
    for (int repeat = 0; repeat < 5; ++repeat) {
        std::atomic<bool> in_loop{false}, went_on{false};
        EXPECT_THROW(run_overlapped(
                         3, 1,
                         [&](std::size_t i) {
                             if (i != 1) return;
                             std::atomic<int> done{0};
                             parallel_for(200, [&](std::size_t) {
                                 in_loop = true;
                                 std::this_thread::sleep_for(std::chrono::microseconds(20));
                                 ++done;
                             });
                             went_on = went_on || done < 200;
                         },
                         [&](std::size_t i) {
                             for (int k = 0; k < 1000 && !in_loop; ++k)
                                 std::this_thread::sleep_for(std::chrono::microseconds(20));
                             if (i == 0) throw std::runtime_error("zero");
                         }),
                     std::runtime_error);
        EXPECT_FALSE(went_on);
    }
}

}  // namespace
}  // namespace postlens::test::threads_test
