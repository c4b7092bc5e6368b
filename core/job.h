// A job: a piece of work with its own number of threads, its own cancellation and its own progress reports.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace postlens {

/// The progress of a job's current step.
struct ProgressReport {
    std::string step;         ///< name of the step, for example "trace"
    double share = 0;         ///< share of the step that is done, 0 to 1
    double seconds = 0;       ///< time since the step began
    double seconds_left = 0;  ///< remaining time of the step, at the same rate
    bool ended = false;       ///< true in the last report of a step, whether it was completed or not
};

struct JobSettings {
    int threads = 0;  ///< may exceed the number of cores; 0 or less: one per core
    /// Receives the progress reports, at most ten per second. Any thread of the job may call it, but never
    /// two at once. It must not throw.
    std::function<void(const ProgressReport&)> watch = {};
};

/// Threads, cancellation and progress reports of one piece of work. Jobs in one process are independent: each
/// has its own threads and is cancelled separately. If a thread that works for one job makes another job, the
/// new job is an inner job. An inner job is cancelled with the outer job and must not outlive it. Without a
/// watcher of its own, the inner job reports to the outer job's watcher. Jobs do not affect the thread pools
/// of other libraries (OpenEXR, OpenImageIO, OpenCV).
class Job {
  public:
    /// Throws Error(out_of_memory) if the system does not allow so many threads.
    explicit Job(JobSettings settings = {});
    ~Job();
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    Job(Job&&) = delete;
    Job& operator=(Job&&) = delete;

    /// The job that the calling thread works for. Outside of every `JobScope`, the job of the process is
    /// returned. That job has one thread per core and no watcher, and it exists until the process ends.
    [[nodiscard]] static Job& current();

    /// Cancels the job: its work throws Error(interrupted) at its next test for cancellation. May be called
    /// from any thread and from signal handlers.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    [[nodiscard]] bool cancelled() const noexcept {
        return cancelled_.load(std::memory_order_relaxed) || (outer_ != nullptr && outer_->cancelled());
    }

    /// Number of threads, at least 1.
    [[nodiscard]] int threads() const noexcept { return threads_; }

    /// Calls `work`. TBB loops inside `work` use only this job's threads.
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
    std::atomic<bool> reporting_{false};  ///< true while a step runs; steps within it do not report
    std::unique_ptr<Threads> arena_;      ///< null: TBB's default arena
};

/// While this object exists, the calling thread and the threads of its parallel loops work for `job`.
/// JobScopes must be destroyed by the thread that made them, in reverse order of construction.
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

/// While this object exists, the calling thread works for an inner job of the current job. The inner job has
/// `threads` threads.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads) : job_({.threads = threads}), scope_(job_) {}

  private:
    Job job_;
    JobScope scope_;
};

/// True if the current job or one of its outer jobs was cancelled. Costs one relaxed atomic load per job.
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
