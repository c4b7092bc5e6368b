// A job: one piece of work with its own number of threads, its own cancellation and its own watcher.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace postlens {

/// How far a job is.
struct ProgressReport {
    std::string step;         ///< what is being done, such as "trace"
    double share = 0;         ///< of this step, 0 to 1
    double seconds = 0;       ///< since its beginning
    double seconds_left = 0;  ///< of this step, as long as it goes on as before
    bool ended = false;       ///< the step is over, done or not; its last report
};

struct JobSettings {
    int threads = 0;  ///< 0 or less: all the machine has; may be more than there are cores
    /// Gets the reports, at most ten a second. Called by any thread that works for the job, never twice at
    /// once; must not throw.
    std::function<void(const ProgressReport&)> watch = {};
};

/// What one piece of work may use and what it listens to. Two jobs in one process do not touch each other:
/// each has threads of its own and is cancelled by itself. A job that is made while the calling thread works
/// for another belongs to that one: it is cancelled with it, reports to its watcher unless it has one, and
/// must not outlive it. Thread pools of other libraries (OpenEXR, OpenImageIO, OpenCV) are not touched.
class Job {
  public:
    explicit Job(JobSettings settings = {});
    ~Job();
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    Job(Job&&) = delete;
    Job& operator=(Job&&) = delete;

    /// The job that the calling thread works for. Outside of every `JobScope` that is the process's own,
    /// which has all threads, no watcher, and ends with the process.
    [[nodiscard]] static Job& current();

    /// Lets the work stop with Error(interrupted) at its next look. From any thread and from signal handlers.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    [[nodiscard]] bool cancelled() const noexcept {
        return cancelled_.load(std::memory_order_relaxed) || (outer_ != nullptr && outer_->cancelled());
    }

    /// At least 1.
    [[nodiscard]] int threads() const noexcept { return threads_; }

    /// Calls `work` so that TBB's loops in it run on this job's threads and none else.
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
    std::atomic<bool> reporting_{false};  ///< a step is under way; steps within it do not report
    std::unique_ptr<Threads> arena_;      ///< absent: TBB's own
};

/// While it lives, the calling thread works for `job`, and so do the threads that its parallel loops use. To
/// be destroyed in the thread that made it, the last made first.
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

/// While it lives, the calling thread works for a job of `threads` threads within the one before.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads) : job_({.threads = threads}), scope_(job_) {}

  private:
    Job job_;
    JobScope scope_;
};

/// Whether the current job was cancelled. Costs one relaxed load of an atomic per job around it.
[[nodiscard]] inline bool interrupted() {
    return Job::current().cancelled();
}

/// Throws Error(interrupted) where the current job was cancelled. Long loops call it at least every 100 ms.
void throw_if_interrupted();

/// How many threads the current job has, at least 1.
[[nodiscard]] inline int thread_count() {
    return Job::current().threads();
}

}  // namespace postlens
