// Runs work in a second thread, while the calling thread handles the signals of Python.
#pragma once

#include <functional>
#include <pybind11/pybind11.h>
#include <string>

namespace postlens::python {

/// Calls `work` as a job with `threads` threads (0: one per core) without the interpreter's lock, and returns
/// when it has finished. Meanwhile the calling thread handles signals, and calls progress(fraction,
/// seconds_left) unless `progress` is None; the last call, after the work has succeeded, is progress(1, 0).
/// Rethrows the exceptions of `work`; errors of postlens become postlens.Error. An exception of a signal
/// handler (KeyboardInterrupt) or of `progress` cancels the work, and is rethrown after the work has stopped.
void run_job(int threads, const pybind11::object& progress, const std::function<void()>& work);

/// The text as a str of Python, in which bytes that are not UTF-8, as in names of files, are surrogates.
[[nodiscard]] pybind11::object text_of(const std::string& text);

/// Calls `call` in the calling thread, and converts errors of postlens to postlens.Error.
void translated(const std::function<void()>& call);

}  // namespace postlens::python
