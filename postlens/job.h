/// @file
/// Jobs (threads, progress, cancellation), the report of a command, and `run` for any command.
#pragma once

#include <functional>
#include <memory>
#include <postlens/error.h>
#include <string>
#include <vector>

namespace postlens::api {

/// The progress of a job's current step. A job may have several steps in succession.
struct Progress {
    std::string step = {};    ///< Name of the step, for example "trace".
    double share = 0;         ///< Completed fraction of the step, 0 to 1.
    double seconds = 0;       ///< Time since the step began, s.
    double seconds_left = 0;  ///< Estimated remaining time of the step, s, at the present rate.
    bool ended = false;  ///< The step has ended, successfully or not. No further progress is reported for it.
};

/// Settings of a job.
struct JobSettings {
    /// Number of threads, 0 to 4096; 0: one per core.
    int threads = 0;
    /// Function that receives the progress, at most ten times per second. Any thread that works for the job
    /// may call it, but only one at a time. It must not throw. It may call `Job::cancel`.
    std::function<void(const Progress&)> watch = {};
};

/// Threads, progress and cancellation of one piece of work. Functions receive a job as their last argument.
/// Without a job, they use one thread per core and report no progress. A job may serve several calls in
/// succession, and must outlive them. The jobs of a process are independent.
class Job {
  public:
    /// Makes a job that is not cancelled. Throws Error(wrong_arguments) if `threads` is out of range.
    /// @param settings Threads and watcher.
    explicit Job(JobSettings settings = {});
    ~Job();
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    Job(Job&&) = delete;
    Job& operator=(Job&&) = delete;

    /// Ends the current call of the job, and every later one, with Error(interrupted). The call ends within
    /// about 0.3 s and leaves no incomplete file. May be called from any thread and from signal handlers.
    void cancel() noexcept;
    /// @return True once `cancel` was called.
    [[nodiscard]] bool cancelled() const noexcept;

  private:
    friend struct Internals;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A warning of a command. The result is complete, but may differ from what the caller intended.
struct Warning {
    std::string code = {};  ///< One word, for example "insufficient".
    std::string text = {};  ///< One line for readers.
    double share = 0;       ///< Fraction of the affected pixels, 0 to 1; 0 if it is not known.
};

/// The report of a command about its work.
struct Report {
    /// `ok`, `comparison_failed` or `shortfall`.
    ExitCode exit_code = ExitCode::ok;
    /// The text that the command prints with `--json`. It contains every figure, also those that have no
    /// member in the results of this interface. JSON has no infinity, so null replaces it.
    std::string json = {};
    std::string text = {};               ///< The text that the command prints for people; several lines.
    std::vector<Warning> warnings = {};  ///< The warnings, in the order in which the command issues them.
    double seconds = 0;                  ///< Duration of the work, s.
};

/// Runs any command as on the command line: `run({"lens", "show", "lens.toml"})`. Throws Error.
/// @param words The words after `postlens`. `--output` is required where the command requires it. `--threads`
/// has
///     no effect: the job sets the number of threads.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The report of the command.
Report run(const std::vector<std::string>& words, Job* job = nullptr);

}  // namespace postlens::api
