// Work in another thread, while the calling one listens to Python.
#pragma once

#include <functional>
#include <pybind11/pybind11.h>

namespace postlens::python {

/// Calls `work` as a job of `threads` threads (0: all the machine has) without holding the interpreter's
/// lock, and comes back when it is done. Meanwhile signals are looked for, and `progress`, unless None, is
/// called as progress(fraction, seconds_left), in the calling thread. What `work` throws comes out, errors of
/// postlens as postlens.Error. An exception of a signal's handler (KeyboardInterrupt) or of `progress`
/// cancels the work and comes out as itself once that has stopped.
void run_job(int threads, const pybind11::object& progress, const std::function<void()>& work);

/// For short calls in the calling thread: errors of postlens become postlens.Error.
void translated(const std::function<void()>& call);

}  // namespace postlens::python
