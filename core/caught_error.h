// Turns any exception into an Error, so that the command, the library and the Python module report the same.
#pragma once

#include "core/error.h"

namespace postlens {

/// Returns the exception that is being handled as an Error. Call it only inside of a catch clause. A
/// std::system_error is that of a thread, because those of files are caught where they are used.
[[nodiscard]] Error caught_error();

}  // namespace postlens
