// Cancels the job of a command when a signal arrives.
#pragma once

#include "core/job.h"

namespace postlens {

/// Makes SIGINT, SIGTERM, SIGHUP and SIGUSR1 cancel `job` instead of ending the process. `job` must exist
/// until the process ends. A signal that was ignored when the process started stays ignored, as under nohup.
/// A second signal removes the unfinished files of OutputFile and then ends the process by the signal's
/// default action. Call this function only in programs, because a library must not install signal handlers.
void cancel_on_signals(Job& job);

/// Returns true if the signal that cancelled the job asks for the work to be continued elsewhere. Batch
/// systems send SIGTERM and SIGUSR1 for this purpose. The other signals mean that the user no longer wants
/// the result.
[[nodiscard]] bool is_asked_to_requeue();

}  // namespace postlens
