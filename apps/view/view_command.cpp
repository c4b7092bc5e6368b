#include "apps/view/view_command.h"

#include <chrono>
#include <memory>
#include <spawn.h>
#include <thread>
#include <unistd.h>

#include "apps/view/view_server.h"

namespace postlens {
namespace {

/// Opens the address in the desktop's browser. Errors are ignored, because the address is also printed.
void open_in_browser(const std::string& address) {
    std::string program = "xdg-open", argument = address;
    std::array<char*, 3> words{program.data(), argument.data(), nullptr};
    pid_t child = 0;
    static_cast<void>(::posix_spawnp(&child, program.c_str(), nullptr, nullptr, words.data(), environ));
}

struct Viewer {
    ViewSession session;
    ViewServer server;
    explicit Viewer(const ViewOptions& options) : session(options), server(session, options.port) {}
};

}  // namespace

CommandResult run_view(const ViewOptions& options) {
    const auto viewer = std::make_shared<Viewer>(options);
    CommandResult out;
    out.text = viewer->server.address();
    out.json["address"] = out.text;
    out.afterwards = [viewer, open = options.open] {
        if (open) open_in_browser(viewer->server.address());
        Job& job = Job::current();
        std::jthread watcher([&](const std::stop_token& served) {
            // `server.stop` has no effect before the server has started, so it is repeated until the server
            // ends.
            while (!served.stop_requested()) {
                if (job.cancelled()) {
                    viewer->session.stop();
                    viewer->server.stop();
                }
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
            }
            viewer->session.stop();
        });
        viewer->server.serve();
    };
    return out;
}

}  // namespace postlens
