// The command `view`, which lets the user refocus a frame interactively in a browser on this machine.
#pragma once

#include "apps/view/view_session.h"

namespace postlens {

/// Serves the viewer until the job is cancelled. Prints its address on standard output. Throws
/// Error(wrong_arguments) if the port is in use, and the errors of opening the frame.
[[nodiscard]] CommandResult run_view(const ViewOptions& options);

}  // namespace postlens
