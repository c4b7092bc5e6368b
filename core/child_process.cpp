#include "core/child_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "core/job.h"

namespace postlens {

ChildResult run_child(const std::vector<std::string>& words, const std::filesystem::path& output) {
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const std::string out = output.empty() ? "/dev/null" : output.string();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t pid = 0;
    const auto start = std::chrono::steady_clock::now();
    const int error = posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) return {.exit_code = 127};
    int status = 0;
    rusage usage{};
    // Kills the child process too if the user cancels, because Ctrl-C may have reached only the parent.
    constexpr std::chrono::milliseconds between_looks(2);
    for (bool cancelled = false;;) {
        const pid_t ended = wait4(pid, &status, cancelled ? 0 : WNOHANG, &usage);
        if (ended == pid) {
            if (cancelled) throw_if_interrupted();
            break;
        }
        if (ended < 0 && errno != EINTR) break;
        if (!cancelled && interrupted()) {
            cancelled = true;
            kill(pid, SIGTERM);
        }
        if (!cancelled) std::this_thread::sleep_for(between_looks);
    }
    ChildResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.peak_memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    return result;
}

}  // namespace postlens
