#include "apps/view/view_command.h"

#include <chrono>
#include <cstdio>
#include <spawn.h>
#include <thread>
#include <unistd.h>

#include "apps/view/view_server.h"

namespace postlens {
namespace {

/// Opens the address in the desktop's browser. A failure is ignored, because the address is also printed.
void open_in_browser(const std::string& address) {
    std::string program = "xdg-open", argument = address;
    std::array<char*, 3> words{program.data(), argument.data(), nullptr};
    pid_t child = 0;
    static_cast<void>(::posix_spawnp(&child, program.c_str(), nullptr, nullptr, words.data(), environ));
}

}  // namespace

CommandResult run_view(const ViewOptions& options) {
    ViewSession session(options);
    ViewServer server(session, options.port);
    // The address must be printed now. The result of the command is only printed after the viewer is closed.
    std::fputs(fmt::format("{}\n", server.address()).c_str(), stdout);
    std::fflush(stdout);
    if (options.open) open_in_browser(server.address());
    Job& job = Job::current();
    std::jthread watcher([&](const std::stop_token& ended) {
        while (!job.cancelled() && !ended.stop_requested())
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        session.stop();
        server.stop();
    });
    server.serve();
    return {};
}

}  // namespace postlens
