// Jobs in one process: each is cancelled by itself, or with the job around it.
#include "core/job.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/progress.h"
#include "core/threads.h"
#include "tests/core/error_text.h"

namespace postlens::test::job_test {
namespace {

/// Waits until `condition` holds, up to a time limit.
template <typename Condition>
bool soon(const Condition& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::yield();
    }
    return true;
}

TEST(Jobs, TwoInOneProcessAreCancelledEachByItself) {
    Job first({.threads = 2}), second({.threads = 2});
    std::atomic<int> first_calls{0}, second_calls{0};
    std::atomic<bool> first_stopped{false};
    // Nested loops: a thread that waits in the inner loop may take other work, which must belong to its job.
    std::thread a([&] {
        const JobScope scope(first);
        EXPECT_EQ(error_text(ExitCode::interrupted,
                             [&] {
                                 parallel_for(1'000'000, [&](std::size_t) {
                                     parallel_for(50, [&](std::size_t) {
                                         EXPECT_EQ(&Job::current(), &first);
                                         ++first_calls;
                                     });
                                 });
                             }),
                  "interrupted; unfinished output was removed");
        first_stopped = true;
    });
    std::thread b([&] {
        const JobScope scope(second);
        parallel_for(400, [&](std::size_t i) {
            parallel_for(50, [&](std::size_t) {
                EXPECT_EQ(&Job::current(), &second);
                ++second_calls;
            });
            if (i == 399) {
                EXPECT_TRUE(soon([&] { return first_calls > 100; }));
                first.cancel();
                EXPECT_TRUE(soon([&] { return first_stopped.load(); }));
            }
        });
    });
    a.join();
    b.join();
    EXPECT_TRUE(first.cancelled());
    EXPECT_FALSE(second.cancelled());
    EXPECT_EQ(second_calls, 400 * 50);
    EXPECT_FALSE(interrupted());
}

TEST(Jobs, WithinAnotherAreCancelledWithItAndReportToItsWatcher) {
    std::vector<ProgressReport> reports;
    Job outer({.watch = [&](const ProgressReport& report) { reports.push_back(report); }});
    const JobScope scope(outer);
    {
        const ThreadLimit inner(1);
        EXPECT_NE(&Job::current(), &outer);
        Progress step("views", 4);
        step.advance();
        std::this_thread::sleep_for(std::chrono::milliseconds(120));
        Progress part("rows", 100);  // a part of the step, which is not reported
        part.advance(50);
        step.advance();
        outer.cancel();
        EXPECT_TRUE(interrupted());
    }
    ASSERT_EQ(reports.size(), 2U);
    EXPECT_EQ(reports[0].step, "views");
    EXPECT_EQ(reports[0].share, 0.5);
    EXPECT_GE(reports[0].seconds_left, 0.12);
    EXPECT_FALSE(reports[0].ended);
    EXPECT_TRUE(reports[1].ended);
}

}  // namespace
}  // namespace postlens::test::job_test
