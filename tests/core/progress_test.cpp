// Durations in words, and the progress bar of a terminal.
#include "core/progress.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <pty.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "core/job.h"

namespace postlens::test::progress_test {
namespace {

using testing::AllOf;
using testing::StartsWith;

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

}  // namespace
}  // namespace postlens::test::progress_test
