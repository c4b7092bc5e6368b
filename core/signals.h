// Cancels the job of a command when a signal arrives.
#pragma once

#include "core/job.h"

namespace postlens {

/// Makes SIGINT, SIGTERM, SIGHUP and SIGUSR1 cancel `job`, which must exist until the process ends. Signals
/// that are already ignored stay ignored, as under nohup. A second signal removes the unfinished files of
/// OutputFile and ends the process.
///
/// Only programs may call this function, because a library must not install signal handlers.
void cancel_on_signals(Job& job);

/// Returns true if the signal that cancelled the job asks to continue the work elsewhere. Batch systems send
/// SIGTERM and SIGUSR1 for this purpose.
[[nodiscard]] bool is_asked_to_requeue();

}  // namespace postlens
