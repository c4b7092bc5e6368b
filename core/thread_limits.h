// Limits of the system on the number of threads.
#pragma once

#include <string>
#include <system_error>

namespace postlens {

/// Throws Error(out_of_memory) unless the system allows `number` more threads. Tests this by starting and
/// ending them: if TBB could not start a thread later, it would abort the process or wait forever.
void require_threads(int number);

/// Text of the error message if a thread cannot be started.
[[nodiscard]] std::string thread_error_text(const std::system_error& error);

/// Number of threads that the OpenEXR library may keep in addition to the threads of jobs.
[[nodiscard]] int library_threads();

}  // namespace postlens
