/// @file
/// Jobs (threads, progress, cancellation), the report of a command, and `run` for any command.
#pragma once

#include <functional>
#include <memory>
#include <postlens/error.h>
#include <string>
#include <vector>

namespace postlens::api {

/// The progress of a job's current step. A job may have several steps, one after the other.
struct Progress {
    std::string step = {};    ///< Name of the step, for example "trace".
    double share = 0;         ///< Completed fraction of the step, 0 to 1.
    double seconds = 0;       ///< Time since the step began, s.
    double seconds_left = 0;  ///< Estimated remaining time of the step at the present rate, s.
    bool ended = false;  ///< True if the step has ended, successfully or not, and reports no more progress.
};

/// Settings of a job.
struct JobSettings {
    /// Number of threads, from 0 to 4096. 0 means one thread per core.
    int threads = 0;
    /// Function that receives the progress, at most ten times per second. It is called by one thread at a
    /// time, which may be any thread that works for the job. It must not throw, but it may call
    /// `Job::cancel`.
    std::function<void(const Progress&)> watch = {};
};

/// Threads, progress and cancellation of one piece of work. A job is the last argument of a function. Without
/// a job, a function uses one thread per core and reports no progress. A job may be used for several calls,
/// one after the other, and must outlive them. Different jobs do not affect each other.
class Job {
  public:
    /// Makes a job, which is initially not cancelled. Throws Error(wrong_arguments) if `threads` is out of
    /// range.
    /// @param settings Number of threads, and the function that receives the progress.
    explicit Job(JobSettings settings = {});
    ~Job();
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    Job(Job&&) = delete;
    Job& operator=(Job&&) = delete;

    /// Cancels the job. The current call and every later call with this job throw Error(interrupted). The
    /// current call ends within about 0.3 s and leaves no incomplete file. Any thread or signal handler may
    /// call this function.
    void cancel() noexcept;
    /// @return True once `cancel` was called.
    [[nodiscard]] bool cancelled() const noexcept;

  private:
    friend struct Internals;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A warning of a command. The result is complete, but may not be what the caller intended.
struct Warning {
    std::string code = {};  ///< One word, for example "insufficient".
    std::string text = {};  ///< One line for readers.
    double share = 0;       ///< Fraction of the pixels that are affected, 0 to 1, or 0 if it is not known.
};

/// The report of a command about its work.
struct Report {
    /// `ok`, `comparison_failed` or `shortfall`.
    ExitCode exit_code = ExitCode::ok;
    /// The JSON text that the command prints with `--json`. It also contains values that the result types of
    /// this interface do not have. Infinity is written as null, because JSON has no infinity.
    std::string json = {};
    std::string text = {};               ///< The text that the command prints for people, in several lines.
    std::vector<Warning> warnings = {};  ///< The warnings, in the order in which the command issues them.
    double seconds = 0;                  ///< Duration of the work, s.
};

/// Runs any command as on the command line, for example `run({"lens", "show", "lens.toml"})`. Throws the
/// Error with which the command ends if it fails.
/// @param words The words after `postlens`. `--output` is required if the command requires it. `--threads`
/// has no effect, because the job sets the number of threads.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The report of the command.
Report run(const std::vector<std::string>& words, Job* job = nullptr);

}  // namespace postlens::api
