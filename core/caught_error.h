// Converts any exception into an Error, so that the command, the library and the Python module report every
// failure in the same form.
#pragma once

#include "core/error.h"

namespace postlens {

/// Returns the exception that is being handled, converted to an Error. Call this function only inside a catch
/// clause. A std::system_error is reported as a failure to start a thread, because code that uses files
/// handles its own system errors.
[[nodiscard]] Error caught_error();

}  // namespace postlens
