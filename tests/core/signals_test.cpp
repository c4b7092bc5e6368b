// Signals and cancelled jobs: loops stop, and no temporary file is left.
#include "core/signals.h"

#include <atomic>
#include <csignal>
#include <cstddef>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"
#include "core/files/output_file.h"
#include "core/job.h"
#include "core/threads.h"
#include "tests/core/error_text.h"
#include "tests/core/folder_test.h"

namespace postlens::test::signals_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

class InterruptTest : public FolderTest {
  protected:
    // A program in the background of a script may have been started with signals ignored.
    InterruptTest() {
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) ::signal(signal, SIG_DFL);
    }
    Job job_;
};

TEST_F(InterruptTest, ACancelledJobBecomesAnErrorWithItsExitCode) {
    const JobScope scope(job_);
    EXPECT_FALSE(interrupted());
    EXPECT_NO_THROW(throw_if_interrupted());
    job_.cancel();
    EXPECT_TRUE(interrupted());
    EXPECT_THAT(error_text(ExitCode::interrupted, throw_if_interrupted), StartsWith("interrupted"));
    EXPECT_EQ(static_cast<int>(ExitCode::interrupted), 130);
}

TEST_F(InterruptTest, OneSignalCancelsTheJobAndDestructorsRun) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
        const int status = status_of_child([&] {
            cancel_on_signals(job_);
            {
                OutputFile file(folder_ / "picture.exr");
                ::raise(signal);
            }
            const bool requeue = signal == SIGTERM || signal == SIGUSR1;
            ::_exit(job_.cancelled() && is_asked_to_requeue() == requeue ? 7 : 8);
        });
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << "signal " << signal << ": " << status;
        EXPECT_THAT(names_in(folder_), IsEmpty());
    }
}

TEST_F(InterruptTest, ASecondSignalEndsTheProcessAndLeavesNoTemporary) {
    write_bytes(folder_ / "kept.exr", "older");
    const int status = status_of_child([&] {
        cancel_on_signals(job_);
        OutputFile first(folder_ / "kept.exr");
        OutputFile second(folder_ / "new.exr");
        ::raise(SIGINT);
        ::raise(SIGTERM);
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
    EXPECT_THAT(names_in(folder_), ElementsAre("kept.exr"));
    EXPECT_EQ(bytes_of(folder_ / "kept.exr"), "older");
}

TEST_F(InterruptTest, ASignalIgnoredFromTheStartStaysIgnored) {
    // nohup ignores SIGHUP in this way.
    const int status = status_of_child([&] {
        ::signal(SIGHUP, SIG_IGN);
        cancel_on_signals(job_);
        ::raise(SIGHUP);
        ::raise(SIGHUP);
        ::_exit(job_.cancelled() ? 8 : 7);
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
}

TEST_F(InterruptTest, LoopsStopSoonAndSayWhy) {
    for (const int threads : {1, 2}) {
        Job job({.threads = threads});
        const JobScope scope(job);
        std::atomic<std::size_t> calls{0};
        // With plain TBB ranges, a thread would process thousands of indices without checking for
        // cancellation.
        const std::string text = error_text(ExitCode::interrupted, [&] {
            parallel_for(100000, [&](std::size_t) {
                if (calls.fetch_add(1) == 10) job.cancel();
            });
        });
        EXPECT_EQ(text, "interrupted; unfinished output was removed");
        // Other threads only finish calls that they had already begun.
        if (threads == 1) {
            EXPECT_EQ(calls, 11U);
        }
        EXPECT_LT(calls, 100000U);
    }
}

TEST_F(InterruptTest, GrainIsTheDistanceBetweenChecks) {
    Job job({.threads = 1});
    const JobScope scope(job);
    std::size_t calls = 0;
    error_text(ExitCode::interrupted, [&] {
        parallel_for(
            100000,
            [&](std::size_t) {
                if (calls++ == 0) job.cancel();
            },
            64);
    });
    EXPECT_LE(calls, 64U);
}

}  // namespace
}  // namespace postlens::test::signals_test
