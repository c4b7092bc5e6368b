#include "core/job.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>
#include <utility>

#include "core/error.h"
#include "core/thread_limits.h"

namespace postlens {
namespace {

thread_local Job* current_job = nullptr;

/// Raises TBB's limit for the number of threads, by default one per core, if a job needs more. Each job adds
/// its number of threads when it begins, and removes it when it ends. The limit is the largest of these
/// numbers.
class WidestJob {
  public:
    void add(int threads) {
        const std::lock_guard lock(mutex_);
        if (threads > 1 && threads > most_tried_) {
            require_threads(threads - 1 + library_threads() + picture_module_threads);
            most_tried_ = threads;
        }
        threads_.insert(threads);
        allow();
    }
    void remove(int threads) {
        const std::lock_guard lock(mutex_);
        threads_.erase(threads_.find(threads));
        allow();
    }
    [[nodiscard]] static WidestJob& instance() {
        static WidestJob widest;
        return widest;
    }

  private:
    void allow() {
        const int widest = threads_.empty() ? 0 : *threads_.rbegin();
        if (widest == allowed_) return;
        allowed_ = widest;
        // Removes the old limit on the number of threads before it sets a new one. As long as several limits
        // exist, TBB applies the lowest.
        control_.reset();
        if (widest > tbb::info::default_concurrency()) {
            control_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(widest));
        }
    }

    std::mutex mutex_;
    std::multiset<int> threads_;
    int allowed_ = 0;
    int most_tried_ = 1;  ///< largest number of threads for which require_threads has succeeded
    std::optional<tbb::global_control> control_;
};

}  // namespace

struct Job::Threads {
    explicit Threads(int number) : arena(number), threads(number) { WidestJob::instance().add(number); }
    ~Threads() { WidestJob::instance().remove(threads); }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;
    Threads(Threads&&) = delete;
    Threads& operator=(Threads&&) = delete;

    tbb::task_arena arena;
    int threads;
};

Job::Job(JobSettings settings)
    : outer_(current_job),
      threads_(settings.threads > 0 ? settings.threads : tbb::info::default_concurrency()),
      watch_(std::move(settings.watch)),
      arena_(std::make_unique<Threads>(threads_)) {}

Job::Job(OfProcess /*process*/) : threads_(tbb::info::default_concurrency()) {}

Job::~Job() = default;

Job& Job::current() {
    if (current_job != nullptr) return *current_job;
    static Job of_process{OfProcess{}};
    return of_process;
}

void Job::run(const std::function<void()>& work) {
    if (!arena_) {
        work();
        return;
    }
    // TBB may run this lambda in another thread than the caller's. Each thread stores which job it works for
    // (`current_job`), and JobScope sets this for the lambda.
    arena_->arena.execute([&] {
        const JobScope scope(*this);
        work();
    });
}

JobScope::JobScope(Job& job) : before_(std::exchange(current_job, &job)) {}

JobScope::~JobScope() {
    current_job = before_;
}

void throw_if_interrupted() {
    if (interrupted()) fail(ExitCode::interrupted, "interrupted; unfinished output was removed");
}

}  // namespace postlens
