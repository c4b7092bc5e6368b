// The viewer's HTTP server. It answers only requests from the viewer's own page.
#pragma once

#include <memory>
#include <string>

#include "apps/view/view_session.h"

namespace postlens {

/// Serves the viewer's page and the replies of a session on 127.0.0.1.
/// Other sites have no access: every URL contains a random token, and a foreign Host or Origin is refused.
/// The page loads nothing from other servers.
class ViewServer {
  public:
    /// Listens on the given TCP port, or on any free port if `port` is 0. Throws Error(wrong_arguments) if
    /// the port is in use.
    ViewServer(ViewSession& session, int port);
    ~ViewServer();
    ViewServer(const ViewServer&) = delete;
    ViewServer& operator=(const ViewServer&) = delete;
    ViewServer(ViewServer&&) = delete;
    ViewServer& operator=(ViewServer&&) = delete;

    /// "http://127.0.0.1:PORT/TOKEN/"
    [[nodiscard]] const std::string& address() const;
    /// Serves requests until `stop` is called.
    void serve();
    /// Ends `serve`. Called from another thread.
    void stop();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
