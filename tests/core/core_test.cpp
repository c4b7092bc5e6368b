// Output files that are complete or absent, signals, progress, and parallel loops.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <pty.h>
#include <set>
#include <stdexcept>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "core/error.h"
#include "core/files/output_file.h"
#include "core/job.h"
#include "core/multiversion.h"
#include "core/progress.h"
#include "core/signals.h"
#include "core/threads.h"

namespace postlens {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

void write_text(const fs::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

std::string read_text(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// The message of the Error with exit code `code` that `action` must throw.
template <typename Action>
std::string error_text(ExitCode code, const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

/// Runs `action` in a child process and returns the status of waitpid. The child exits with 99 on an
/// exception.
template <typename Action>
int status_of_child(const Action& action) {
    const pid_t child = ::fork();
    if (child == 0) {
        try {
            action();
        } catch (...) {
            ::_exit(99);
        }
        ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
}

class OutputFileTest : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "postlens_core_test.XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path folder_;
};

TEST_F(OutputFileTest, IsAbsentUntilCommittedAndWholeAfterwards) {
    OutputFile file(folder_ / "picture.exr");
    EXPECT_EQ(file.target(), folder_ / "picture.exr");
    EXPECT_EQ(file.temporary_path().parent_path(), folder_);
    EXPECT_EQ(file.temporary_path().extension(), ".exr");
    write_text(file.temporary_path(), "whole");
    EXPECT_FALSE(fs::exists(file.target()));
    file.commit();
    EXPECT_EQ(read_text(file.target()), "whole");
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, WithoutCommitTheOlderTargetStaysAndNoTemporary) {
    const fs::path target = folder_ / "picture.exr";
    write_text(target, "older");
    EXPECT_THROW(
        {
            OutputFile file(target);
            write_text(file.temporary_path(), "half");
            throw std::runtime_error("the writer failed");
        },
        std::runtime_error);
    EXPECT_EQ(read_text(target), "older");
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, CommitReplacesTheTarget) {
    const fs::path target = folder_ / "picture.exr";
    write_text(target, "a longer, older text");
    {
        OutputFile file(target);
        write_text(file.temporary_path(), "newer");
        EXPECT_EQ(read_text(target), "a longer, older text");
        file.commit();
    }
    EXPECT_EQ(read_text(target), "newer");
}

TEST_F(OutputFileTest, TwoFilesOfOneNameDoNotShareATemporary) {
    // Two runs in different containers may have the same process id and write the same picture.exr.
    OutputFile first(folder_ / "picture.exr");
    OutputFile second(folder_ / "picture.exr");
    EXPECT_NE(first.temporary_path(), second.temporary_path());
    write_text(first.temporary_path(), "first");
    write_text(second.temporary_path(), "second");
    first.commit();
    EXPECT_EQ(read_text(folder_ / "picture.exr"), "first");
    second.commit();
    EXPECT_EQ(read_text(folder_ / "picture.exr"), "second");
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, KeepsASymbolicLinkAndReplacesWhatItLeadsTo) {
    fs::create_directory(folder_ / "disk");
    write_text(folder_ / "disk" / "real.exr", "older");
    fs::create_symlink(folder_ / "disk" / "real.exr", folder_ / "link.exr");
    OutputFile file(folder_ / "link.exr");
    EXPECT_EQ(file.temporary_path().parent_path(), fs::canonical(folder_ / "disk"));
    write_text(file.temporary_path(), "newer");
    file.commit();
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.exr"));
    EXPECT_EQ(read_text(folder_ / "disk" / "real.exr"), "newer");
}

TEST_F(OutputFileTest, NewFilesHaveThePermissionsThatTheUserMaskLeaves) {
    const mode_t old_mask = ::umask(027);
    OutputFile file(folder_ / "picture.exr");
    ::umask(old_mask);
    file.commit();
    EXPECT_EQ(static_cast<unsigned>(fs::status(file.target()).permissions()), 0640U);
}

TEST_F(OutputFileTest, TakesANameAsLongAsAFileSystemAllows) {
    const std::string name = std::string(251, 'n') + ".exr";
    OutputFile file(folder_ / name);
    file.commit();
    EXPECT_THAT(names_in(folder_), ElementsAre(name));
}

TEST_F(OutputFileTest, TakesANameWithoutAFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    {
        OutputFile file("picture.png");
        write_text(file.temporary_path(), "here");
        file.commit();
    }
    fs::current_path(before);
    EXPECT_EQ(read_text(folder_ / "picture.png"), "here");
}

TEST_F(OutputFileTest, RefusesAFolder) {
    for (const fs::path& target : {folder_, folder_ / ""}) {
        EXPECT_EQ(error_text(ExitCode::cannot_write, [&] { OutputFile file(target); }),
                  target.string() + ": cannot write (got a folder; expected a file name)");
    }
    EXPECT_THAT(names_in(folder_), IsEmpty());
}

TEST_F(OutputFileTest, RefusesAMissingFolder) {
    const fs::path target = folder_ / "missing" / "picture.exr";
    EXPECT_EQ(
        error_text(ExitCode::cannot_write, [&] { OutputFile file(target); }),
        target.string() + ": cannot write (folder " + (folder_ / "missing").string() + " does not exist)");
}

TEST_F(OutputFileTest, RefusesADeviceInsteadOfReplacingIt) {
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0666), 0);
    EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { OutputFile file(pipe); }), HasSubstr("device"));
    EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { OutputFile file("/dev/null"); }),
                HasSubstr("device"));
    EXPECT_TRUE(fs::is_fifo(pipe));
}

/// Root ignores file permissions, so a child process that tests them changes to another user first.
void give_up_root() {
    constexpr uid_t nobody = 65534;
    if (::geteuid() != 0) return;
    if (::setgid(nobody) != 0 || ::setuid(nobody) != 0) throw std::runtime_error("cannot give up root");
}

TEST_F(OutputFileTest, RefusesAFolderThatMayNotBeWritten) {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                                 fs::perms::others_exec);
    const fs::path target = folder_ / "picture.exr";
    const int status = status_of_child([&] {
        give_up_root();
        const std::string text = error_text(ExitCode::cannot_write, [&] { OutputFile file(target); });
        ::_exit(text == target.string() + ": cannot write (Permission denied)" ? 7 : 8);
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
    fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(OutputFileTest, RefusesAFileThatItsOwnerProtected) {
    const fs::path target = folder_ / "picture.exr";
    write_text(target, "older");
    fs::permissions(folder_, fs::perms::all);
    fs::permissions(target, fs::perms::owner_read | fs::perms::others_read);
    const int status = status_of_child([&] {
        give_up_root();
        const std::string text = error_text(ExitCode::cannot_write, [&] { OutputFile file(target); });
        ::_exit(text == target.string() + ": cannot write (Permission denied)" ? 7 : 8);
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, CommitSaysWhenTheTemporaryIsGone) {
    const fs::path target = folder_ / "picture.exr";
    write_text(target, "older");
    OutputFile file(target);
    fs::remove(file.temporary_path());
    EXPECT_EQ(error_text(ExitCode::cannot_write, [&] { file.commit(); }),
              target.string() + ": cannot write (No such file or directory)");
    EXPECT_EQ(read_text(target), "older");
}

TEST_F(OutputFileTest, CommitSaysWhenTheTargetBecameAFolder) {
    const fs::path target = folder_ / "picture.exr";
    {
        OutputFile file(target);
        fs::create_directory(target);
        EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { file.commit(); }),
                    StartsWith(target.string() + ": cannot write ("));
    }
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
    EXPECT_THAT(names_in(target), IsEmpty());
}

TEST_F(OutputFileTest, MoreFilesThanAreListedForSignalsAreWrittenAllTheSame) {
    constexpr int count = 100;
    {
        std::vector<std::unique_ptr<OutputFile>> files;
        files.reserve(count);
        for (int i = 0; i < count; ++i) {
            files.push_back(std::make_unique<OutputFile>(folder_ / fmt::format("f.{:04}.exr", i)));
        }
        for (int i = 0; i < count; i += 2) files[static_cast<std::size_t>(i)]->commit();
    }
    EXPECT_EQ(names_in(folder_).size(), count / 2U);
}

class InterruptTest : public OutputFileTest {
  protected:
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
    write_text(folder_ / "kept.exr", "older");
    const int status = status_of_child([&] {
        cancel_on_signals(job_);
        OutputFile first(folder_ / "kept.exr");
        OutputFile second(folder_ / "new.exr");
        ::raise(SIGINT);
        ::raise(SIGTERM);
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
    EXPECT_THAT(names_in(folder_), ElementsAre("kept.exr"));
    EXPECT_EQ(read_text(folder_ / "kept.exr"), "older");
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

TEST(Duration, IsWrittenInTheUnitThatFits) {
    EXPECT_EQ(duration_text(0), "0 s");
    EXPECT_EQ(duration_text(7.6), "8 s");
    EXPECT_EQ(duration_text(59.4), "59 s");
    EXPECT_EQ(duration_text(59.6), "1 min 00 s");
    EXPECT_EQ(duration_text(185), "3 min 05 s");
    EXPECT_EQ(duration_text(3599.7), "1 h 00 min");
    EXPECT_EQ(duration_text(2 * 3600 + 7 * 60 + 59), "2 h 07 min");
    EXPECT_EQ(duration_text(-1), "0 s");
    EXPECT_EQ(duration_text(std::nan("")), "0 s");
    EXPECT_EQ(duration_text(std::numeric_limits<double>::infinity()), "24000 h 00 min");
}

/// Advances by one fifth at once, and by another fifth after the second that the bar waits before it appears.
void advance_over_a_second(bool quiet) {
    Job job({.watch = quiet ? nullptr : terminal_bar()});
    const JobScope scope(job);
    Progress progress("trace", 5);
    progress.advance();
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    progress.advance();
}

TEST(ProgressTest, PrintsNothingWhenStderrIsNoTerminal) {
    testing::internal::CaptureStderr();
    advance_over_a_second(false);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// The stderr output of a child process on a terminal of type `term`.
std::string on_terminal(const char* term, bool quiet) {
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        ::setenv("TERM", term, 1);
        advance_over_a_second(quiet);
        ::_exit(0);
    }
    EXPECT_GT(child, 0);
    std::string text;
    std::array<char, 512> block{};
    // The read fails with EIO after the child has exited.
    for (ssize_t n = 0; (n = ::read(terminal, block.data(), block.size())) > 0;) {
        text.append(block.data(), static_cast<std::size_t>(n));
    }
    ::close(terminal);
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    return text;
}

TEST(ProgressTest, DrawsABarOnATerminalAndWipesIt) {
    // Two fifths of 30 columns are 12. The remaining three fifths take 1.5 times the elapsed 1.1 s.
    const std::string bar = "[" + std::string(12, '=') + std::string(18, ' ') + "]";
    const std::string wipe = "\r\033[K";
    const std::string text = on_terminal("xterm", false);
    EXPECT_THAT(text, AllOf(StartsWith("\rtrace " + bar + "  40 %  2 s left"), testing::EndsWith(wipe)));
}

TEST(ProgressTest, PrintsNothingWhenQuietOrOnATerminalWithoutControlSequences) {
    EXPECT_EQ(on_terminal("xterm", true), "");
    EXPECT_EQ(on_terminal("dumb", false), "");
}

POSTLENS_MULTIVERSION void multiply_add(const float* a, const float* b, float* sum, int count) {
    for (int i = 0; i < count; ++i) sum[i] = sum[i] + a[i] * b[i];
}

TEST(Multiversion, RoundsAsTheBaseInstructionSetDoes) {
    std::vector<float> a(1001), b(1001), sum(1001), expected(1001);
    for (std::size_t i = 0; i < a.size(); ++i) {
        a[i] = 1.0F + static_cast<float>(i) * 1.1e-3F;
        b[i] = 1.0F / a[i];
        sum[i] = -1.0F;
        // The volatile variable forces the product to be rounded, so that the compiler cannot fuse it.
        const volatile float product = a[i] * b[i];
        expected[i] = sum[i] + product;
    }
    // At least one product must be inexact: otherwise a fused operation would give the same results.
    std::size_t fused_differs = 0;
    for (std::size_t i = 0; i < a.size(); ++i) fused_differs += std::fma(a[i], b[i], sum[i]) != expected[i];
    EXPECT_GT(fused_differs, 0U);
    multiply_add(a.data(), b.data(), sum.data(), static_cast<int>(sum.size()));
    EXPECT_EQ(sum, expected);
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

}  // namespace
}  // namespace postlens
