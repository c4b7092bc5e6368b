// The viewer's HTTP server: who may ask, and for what.
#pragma once

#include <memory>
#include <string>

#include "apps/view_session.h"

namespace postlens {

/// Serves the page and a session's replies on 127.0.0.1. Every address begins with a random token; requests
/// of other pages (a foreign Host or Origin) are refused; nothing is loaded from elsewhere.
class ViewServer {
  public:
    /// Binds the port (0: any free one). Throws Error(wrong_arguments) where it is taken.
    ViewServer(ViewSession& session, int port);
    ~ViewServer();
    ViewServer(const ViewServer&) = delete;
    ViewServer& operator=(const ViewServer&) = delete;
    ViewServer(ViewServer&&) = delete;
    ViewServer& operator=(ViewServer&&) = delete;

    /// "http://127.0.0.1:PORT/TOKEN/"
    [[nodiscard]] const std::string& address() const;
    /// Until `stop`.
    void serve();
    /// From another thread.
    void stop();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
