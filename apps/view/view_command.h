// The command `view`. The user refocuses a frame interactively in a browser on the same machine.
#pragma once

#include "apps/view/view_session.h"

namespace postlens {

/// Starts the viewer's web server, prints its address, and serves requests until the current job is
/// cancelled. Throws Error(wrong_arguments) if the port is in use. Also throws the errors that occur when the
/// frame is opened.
[[nodiscard]] CommandResult run_view(const ViewOptions& options);

}  // namespace postlens
