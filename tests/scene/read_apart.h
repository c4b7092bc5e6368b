// Reads a scene file in a separate process with limited time and memory.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <string>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <tuple>
#include <unistd.h>

#include "core/error.h"
#include "scene/scene.h"

namespace postlens::test {

/// The result of `read_apart`.
struct ReadOutcome {
    bool loaded = false;
    bool refused = false;  ///< with exit code 3 and a one-line message
    std::string text;      ///< the error message, or the signal that ended the process
};

/// Reads a scene file in a separate process, which is limited to 10 seconds and 1 GiB.
inline ReadOutcome read_apart(const std::filesystem::path& path) {
    int pipe_ends[2];
    if (::pipe(pipe_ends) != 0) return {false, false, "no pipe"};
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(pipe_ends[0]);
        ::alarm(10);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        // Sanitizers reserve more address space than that when they start.
        const rlimit limit{rlim_t{1} << 30, rlim_t{1} << 30};
        ::setrlimit(RLIMIT_AS, &limit);
#endif
        int code = 0;
        std::string text;
        try {
            std::ignore = read_scene(path);
        } catch (const Error& e) {
            code = static_cast<int>(e.code());
            text = e.what();
        } catch (const std::exception& e) {
            code = 100;
            text = e.what();
        }
        std::ignore = ::write(pipe_ends[1], text.data(), text.size());
        ::_exit(code);
    }
    ::close(pipe_ends[1]);
    ReadOutcome out;
    char part[512];
    for (ssize_t n = 0; (n = ::read(pipe_ends[0], part, sizeof part)) > 0;) {
        out.text.append(part, static_cast<std::size_t>(n));
    }
    ::close(pipe_ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    out.loaded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    out.refused = WIFEXITED(status) && WEXITSTATUS(status) == 3 && !out.text.empty() &&
                  out.text.find('\n') == std::string::npos;
    if (WIFSIGNALED(status)) out.text = "killed by signal " + std::to_string(WTERMSIG(status));
    return out;
}

}  // namespace postlens::test
