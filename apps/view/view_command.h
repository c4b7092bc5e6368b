// The command `view`. The user refocuses a frame interactively in a browser on the same machine.
#pragma once

#include "apps/view/view_session.h"

namespace postlens {

/// Prints the address of the viewer, and serves the viewer until the job is cancelled. Throws
/// Error(wrong_arguments) if the port is in use, and the errors of opening the frame.
[[nodiscard]] CommandResult run_view(const ViewOptions& options);

}  // namespace postlens
