// Signals cancel a command's job.
#pragma once

#include "core/job.h"

namespace postlens {

/// Makes SIGINT, SIGTERM and SIGHUP cancel `job` instead of ending the process. `job` must exist until the
/// process ends. A signal that the process was started to ignore (nohup, a background job of a script) stays
/// ignored. A second signal removes the files that OutputFile has not committed, and then ends the process by
/// its default action. Only for programs, because a library must not install signal handlers.
void cancel_on_signals(Job& job);

}  // namespace postlens
