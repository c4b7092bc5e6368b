// Converts any exception to an Error, so that the command, the library and the Python module report failures
// alike.
#pragma once

#include "core/error.h"

namespace postlens {

/// Returns the exception that is being handled, converted to an Error. Call it only inside a catch clause. A
/// std::filesystem::filesystem_error becomes Error(invalid_input). Any other std::system_error becomes
/// Error(out_of_memory), because here it means that a thread could not be started.
[[nodiscard]] Error caught_error();

}  // namespace postlens
