// A fixture that runs the command through a shell and checks its output, messages and files.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "core/error.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {

/// Waits until `process` handles SIGINT, up to 30 s. A signal that arrives earlier kills the process, and the
/// loader alone may take a second on a busy machine. SigCgt is a hexadecimal mask of the handled signals
/// [proc(5)].
inline void wait_for_handler(pid_t process) {
    for (int i = 0; i < 600; ++i) {
        std::ifstream status("/proc/" + std::to_string(process) + "/status");
        for (std::string line; std::getline(status, line);) {
            if (line.rfind("SigCgt:", 0) == 0 &&
                (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1U) != 0)
                return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
}

/// Waits until `process` has computed for this long, up to 30 s: on a busy machine it may take long to start.
inline void wait_for_work(pid_t process, std::chrono::milliseconds work) {
    clockid_t clock{};
    if (::clock_getcpuclockid(process, &clock) != 0) return;
    for (int i = 0; i < 6000; ++i) {
        timespec used{};
        if (::clock_gettime(clock, &used) != 0) return;
        if (std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec) >= work) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

/// The words of a command line.
using Words = std::vector<std::string>;

/// The words of `a`, then those of `b`.
inline Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// The result of a command.
struct Outcome {
    int exit_code = -1;
    std::string out, err;
};

/// A word in single quotes for the shell.
inline std::string quoted(const std::string& word) {
    std::string out(1, '\'');
    for (const char c : word) {
        if (c == '\'') out.append("'\\'");  // closes the quotes, adds a quote, opens them again
        out.push_back(c);
    }
    out.push_back('\'');
    return out;
}

/// Runs the command in a test with a folder of its own.
class CommandTest : public testing::Test {
  protected:
    // Runs the command with these arguments; `before` stands in front of it in the line of shell.
    Outcome run(const std::vector<std::string>& words, const std::string& before = "") {
        std::string command = before + test::quoted(program_);
        for (const std::string& w : words) command.append(" ").append(quoted(w));
        const std::filesystem::path out = folder_.path() / ".out", err = folder_.path() / ".err";
        command.append(" >")
            .append(quoted(out.string()))
            .append(" 2>")
            .append(quoted(err.string()))
            .append(" </dev/null");
        const int status = std::system(command.c_str());
        Outcome r{WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), bytes_of(out), bytes_of(err)};
        std::filesystem::remove(out);
        std::filesystem::remove(err);
        return r;
    }
    // The command must end with this exit code and a one-line message that contains `part`, and create no
    // file.
    void refused(const std::vector<std::string>& words, ExitCode code, const std::string& part) {
        const std::size_t before = folder_.file_count();
        const Outcome r = run(words);
        std::string all;
        for (const auto& w : words) all.append(" ").append(w);
        EXPECT_EQ(r.exit_code, static_cast<int>(code)) << all << "\n" << r.err;
        EXPECT_EQ(r.err.rfind("postlens: ", 0), 0U) << all << "\n" << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << all << "\n" << r.err;
        EXPECT_NE(r.err.find(part), std::string::npos) << all << "\n" << r.err;
        EXPECT_EQ(folder_.file_count(), before) << all;
    }
    // The path of a file in the test's folder.
    std::string in(const std::string& name) { return (folder_.path() / name).string(); }
    // Starts the command in the background.
    static pid_t begin(const std::vector<std::string>& words) {
        const pid_t child = ::fork();
        if (child != 0) return child;
        std::vector<char*> arguments;
        std::vector<std::string> all{POSTLENS_BINARY};
        all.insert(all.end(), words.begin(), words.end());
        for (std::string& w : all) arguments.push_back(w.data());
        arguments.push_back(nullptr);
        ::execv(POSTLENS_BINARY, arguments.data());
        ::_exit(127);
    }

    TemporaryFolder folder_;
    std::string program_ = POSTLENS_BINARY;  ///< the program that `run` starts
};

}  // namespace postlens::test
