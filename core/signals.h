// Signals cancel a command's job.
#pragma once

#include "core/job.h"

namespace postlens {

/// Makes SIGINT, SIGTERM, SIGHUP and SIGUSR1 cancel `job` instead of ending the process. `job` must exist
/// until the process ends. Signals that the process was started to ignore (by nohup, or as a script's
/// background job) stay ignored. A second signal removes the uncommitted files of OutputFile, and then ends
/// the process by the signal's default action. Only for programs: a library must not install signal handlers.
void cancel_on_signals(Job& job);

/// True if the signal that cancelled the job asks for the work to be continued elsewhere. Batch systems send
/// SIGTERM and SIGUSR1 for this. Other signals mean that the result is not wanted.
[[nodiscard]] bool is_asked_to_requeue();

}  // namespace postlens
