// Runs work in a second thread, while the calling thread handles Python's signals.
#pragma once

#include <functional>
#include <pybind11/pybind11.h>
#include <string>

namespace postlens::python {

/// Runs `work` as a job with `threads` threads (0: one per core), without the lock of the Python interpreter.
/// If `work` throws an exception, it is thrown again here; exceptions of postlens become postlens.Error.
///
/// The calling thread handles signals and calls progress(fraction, seconds_left), unless `progress` is None.
/// If a signal handler or `progress` raises an exception, `work` is cancelled before this exception is
/// thrown. After success, the last call is progress(1, 0).
void run_job(int threads, const pybind11::object& progress, const std::function<void()>& work);

/// Converts text to a Python str. Bytes that are not UTF-8, as in file names, become surrogates.
[[nodiscard]] pybind11::object text_of(const std::string& text);

/// Calls `call`. Errors of postlens become postlens.Error.
void translated(const std::function<void()>& call);

}  // namespace postlens::python
