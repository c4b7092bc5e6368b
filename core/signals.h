// What a signal does to a command's work.
#pragma once

#include "core/job.h"

namespace postlens {

/// Makes SIGINT, SIGTERM and SIGHUP cancel `job`, which must live as long as the process, instead of ending
/// the process; a signal that the process was started to ignore (nohup, a background job of a script) stays
/// ignored. A second signal ends the process by its default action, after removing what OutputFile has not
/// yet committed. For programs; a library leaves signals to its user.
void cancel_on_signals(Job& job);

}  // namespace postlens
