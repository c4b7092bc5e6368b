// A job is a piece of work with its own threads, cancellation and progress reports.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace postlens {

/// The progress of a job's current step.
struct ProgressReport {
    std::string step;         ///< name of the step, for example "trace"
    double share = 0;         ///< fraction of the step that is done, 0 to 1
    double seconds = 0;       ///< time since the step began
    double seconds_left = 0;  ///< estimated remaining time of the step
    bool ended = false;       ///< true in the last report of a step, even if the step failed
};

struct JobSettings {
    int threads = 0;  ///< may exceed the number of cores; 0 or less means one per core
    /// Receives the progress reports, at most ten per second. Any thread of the job may call it, but only one
    /// at a time. It must not throw.
    std::function<void(const ProgressReport&)> watch = {};
};

/// The threads, the cancellation and the progress reports of one piece of work. Jobs in one process are
/// independent.
///
/// A thread of a job may create an inner job, which must not outlive the outer job. Cancelling the outer job
/// also cancels the inner job. An inner job without a watcher reports to the watcher of the outer job.
///
/// Jobs do not affect the thread pools of other libraries (OpenEXR, OpenImageIO, OpenCV).
class Job {
  public:
    /// Throws Error(out_of_memory) if the system cannot start this number of threads.
    explicit Job(JobSettings settings = {});
    ~Job();
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    Job(Job&&) = delete;
    Job& operator=(Job&&) = delete;

    /// Returns the job that the calling thread works for. Outside of every `JobScope`, it is the default job
    /// of the process, with one thread per core and no progress reports.
    [[nodiscard]] static Job& current();

    /// Cancels the job: its work throws Error(interrupted) at the next check. Any thread and any signal
    /// handler may call this function.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    [[nodiscard]] bool cancelled() const noexcept {
        return cancelled_.load(std::memory_order_relaxed) || (outer_ != nullptr && outer_->cancelled());
    }

    /// Number of threads, at least 1.
    [[nodiscard]] int threads() const noexcept { return threads_; }

    /// Calls `work`. Parallel loops in `work` (TBB) use only the threads of this Job.
    void run(const std::function<void()>& work);

  private:
    friend class Progress;
    struct Threads;
    struct OfProcess {};
    explicit Job(OfProcess /*process*/);

    Job* outer_ = nullptr;
    int threads_ = 1;
    std::function<void(const ProgressReport&)> watch_;
    std::atomic<bool> cancelled_{false};
    std::atomic<bool> reporting_{false};  ///< true while a step runs; nested steps do not report
    std::unique_ptr<Threads> arena_;      ///< null if the job uses TBB's default arena
};

/// Assigns the calling thread to `job` while this object exists. The thread and its parallel loops then use
/// the job's number of threads, report progress to it, and stop if it is cancelled. A thread must destroy its
/// JobScopes itself, in the reverse order of their creation.
class JobScope {
  public:
    explicit JobScope(Job& job);
    ~JobScope();
    JobScope(const JobScope&) = delete;
    JobScope& operator=(const JobScope&) = delete;
    JobScope(JobScope&&) = delete;
    JobScope& operator=(JobScope&&) = delete;

  private:
    Job* before_;
};

/// While this object exists, the parallel loops that the calling thread runs use at most `threads` threads.
/// For this, it creates an inner job of the thread's current Job, with this number of threads.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads) : job_({.threads = threads}), scope_(job_) {}

  private:
    Job job_;
    JobScope scope_;
};

/// Returns true if the current job or one of its outer jobs was cancelled. It is fast: one relaxed atomic
/// load per job.
[[nodiscard]] inline bool interrupted() {
    return Job::current().cancelled();
}

/// Throws Error(interrupted) if the current job was cancelled. Long loops must call it at least every 100 ms.
void throw_if_interrupted();

/// Number of threads of the current job, at least 1.
[[nodiscard]] inline int thread_count() {
    return Job::current().threads();
}

}  // namespace postlens
