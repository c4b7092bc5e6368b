// A job: one piece of work with its own number of threads, its own cancellation and its own progress reports.
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
    bool ended = false;       ///< the step has ended, completed or not; this is its last report
};

struct JobSettings {
    int threads = 0;  ///< number of threads, may exceed the number of cores; 0 or less: one per core
    /// Receives the progress reports, at most ten per second. Called by any thread that works for the job,
    /// but by one at a time; must not throw.
    std::function<void(const ProgressReport&)> watch = {};
};

/// Threads, cancellation and progress reports of one piece of work. Jobs in one process are independent: each
/// has its own threads and is cancelled separately. A job that is made while the calling thread works for
/// another one is that job's inner job: it is cancelled with the outer one, reports to the outer one's
/// watcher unless it has its own, and must not outlive it. Thread pools of other libraries (OpenEXR,
/// OpenImageIO, OpenCV) are not affected.
class Job {
  public:
    explicit Job(JobSettings settings = {});
    ~Job();
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    Job(Job&&) = delete;
    Job& operator=(Job&&) = delete;

    /// The job that the calling thread works for. Outside of every `JobScope` it is the job of the process,
    /// which has one thread per core and no watcher, and ends with the process.
    [[nodiscard]] static Job& current();

    /// Makes the work throw Error(interrupted) at its next test for cancellation. May be called from any
    /// thread and from signal handlers.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    [[nodiscard]] bool cancelled() const noexcept {
        return cancelled_.load(std::memory_order_relaxed) || (outer_ != nullptr && outer_->cancelled());
    }

    /// Number of threads, at least 1.
    [[nodiscard]] int threads() const noexcept { return threads_; }

    /// Calls `work`, whose TBB loops then run on this job's threads only.
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
    std::atomic<bool> reporting_{false};  ///< a step is running; steps within it do not report
    std::unique_ptr<Threads> arena_;      ///< null: TBB's default arena
};

/// During the lifetime of this object, the calling thread and the threads of its parallel loops work for
/// `job`. It must be destroyed by the thread that made it, in reverse order of construction.
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

/// During the lifetime of this object, the calling thread works for an inner job of the current one, with
/// `threads` threads.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads) : job_({.threads = threads}), scope_(job_) {}

  private:
    Job job_;
    JobScope scope_;
};

/// Whether the current job or an outer one was cancelled. Costs one relaxed atomic load per job.
[[nodiscard]] inline bool interrupted() {
    return Job::current().cancelled();
}

/// Throws Error(interrupted) if the current job was cancelled. Long loops call it at least every 100 ms.
void throw_if_interrupted();

/// Number of threads of the current job, at least 1.
[[nodiscard]] inline int thread_count() {
    return Job::current().threads();
}

}  // namespace postlens
