#include "python/run_job.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "core/caught_error.h"
#include "core/job.h"
#include "core/text.h"

namespace py = pybind11;

namespace postlens::python {
namespace {

/// State shared by the working thread and the waiting one, which handles signals and progress.
struct Shared {
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false;
    std::exception_ptr error;
    std::optional<ProgressReport> report;
};

[[noreturn]] void raise(ExitCode code, const std::string& text) {
    py::object make = py::module_::import("postlens._errors").attr("error_of");
    const py::object error = make(static_cast<int>(code), text_of(printable(text)));
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
    throw py::error_already_set();
}

/// Handles signals and calls the Python function `progress`, under the interpreter's lock. Throws
/// py::error_already_set if a signal handler or `progress` raises an exception.
void listen(const py::object& progress, const std::optional<ProgressReport>& report) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (report && !progress.is_none()) progress(report->ended ? 1.0 : report->share, report->seconds_left);
}

}  // namespace

py::object text_of(const std::string& text) {
    return py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
}

void translated(const std::function<void()>& call) {
    try {
        call();
    } catch (...) {
        const Error e = caught_error();
        raise(e.code(), e.what());
    }
}

void run_job(int threads, const py::object& progress, const std::function<void()>& work) {
    Shared shared;
    JobSettings settings{.threads = threads};
    if (!progress.is_none()) {
        settings.watch = [&shared](const ProgressReport& report) {
            const std::lock_guard lock(shared.mutex);
            shared.report = report;
        };
    }
    std::optional<Job> job;
    std::thread worker;
    const auto work_in_job = [&] {
        std::exception_ptr error;
        try {
            const JobScope scope(*job);
            work();
        } catch (...) {
            error = std::current_exception();
        }
        const std::lock_guard lock(shared.mutex);
        shared.error = error;
        shared.done = true;
        shared.changed.notify_all();
    };
    translated([&] {
        job.emplace(std::move(settings));
        worker = std::thread(work_in_job);
    });
    std::exception_ptr of_python;
    {
        const py::gil_scoped_release released;
        std::unique_lock lock(shared.mutex);
        constexpr std::chrono::milliseconds between_looks(50);
        while (!shared.changed.wait_for(lock, between_looks, [&] { return shared.done; })) {
            if (of_python) continue;
            const std::optional<ProgressReport> report = std::exchange(shared.report, std::nullopt);
            lock.unlock();
            {
                const py::gil_scoped_acquire acquired;
                try {
                    listen(progress, report);
                } catch (py::error_already_set&) {
                    of_python = std::current_exception();
                    job->cancel();
                }
            }
            lock.lock();
        }
        lock.unlock();
        worker.join();
    }
    if (of_python) std::rethrow_exception(of_python);
    if (shared.error) translated([&] { std::rethrow_exception(shared.error); });
    if (!progress.is_none()) progress(1.0, 0.0);
}

}  // namespace postlens::python
