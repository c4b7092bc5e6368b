// Signals cancel a command's job.
#pragma once

#include "core/job.h"

namespace postlens {

/// Makes SIGINT, SIGTERM, SIGHUP and SIGUSR1 cancel `job` instead of ending the process. `job` must exist
/// until the process ends. A signal that the process was started to ignore (nohup, a background job of a
/// script) stays ignored. A second signal removes the files that OutputFile has not committed, and then ends
/// the process by its default action. Only for programs, because a library must not install signal handlers.
void cancel_on_signals(Job& job);

/// Whether the signal that cancelled the job means that the work is to be continued elsewhere. SIGTERM and
/// SIGUSR1 of a batch system mean this; other signals mean that the result is not wanted.
[[nodiscard]] bool is_asked_to_requeue();

}  // namespace postlens
