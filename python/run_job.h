// Runs work in a second thread. The calling thread handles the signals of Python.
#pragma once

#include <functional>
#include <pybind11/pybind11.h>
#include <string>

namespace postlens::python {

/// Runs `work` as a job with `threads` threads, or one per core if `threads` is 0. Returns when the job has
/// ended. `work` runs without the interpreter's lock.
///
/// Meanwhile, the calling thread handles signals and calls progress(fraction, seconds_left), unless
/// `progress` is None. After `work` has succeeded, the last call is progress(1, 0).
///
/// Exceptions of `work` are thrown again here, with errors of postlens converted to postlens.Error. If
/// `progress` or a signal handler raises an exception (such as KeyboardInterrupt), the work is cancelled, and
/// the exception is thrown again when the work has stopped.
void run_job(int threads, const pybind11::object& progress, const std::function<void()>& work);

/// Converts a text to a str of Python. Bytes that are not UTF-8, which occur in names of files, become
/// surrogates.
[[nodiscard]] pybind11::object text_of(const std::string& text);

/// Calls `call` in the calling thread. Errors of postlens are converted to postlens.Error.
void translated(const std::function<void()>& call);

}  // namespace postlens::python
