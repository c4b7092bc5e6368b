// `view`: a frame refocused by hand, in a browser on this machine.
#pragma once

#include "apps/view_session.h"

namespace postlens {

/// Serves the viewer until the job is cancelled. Says where on standard output. Throws Error(wrong_arguments)
/// for a port that is taken, and what opening the frame throws.
[[nodiscard]] CommandResult run_view(const ViewOptions& options);

}  // namespace postlens
