#include "postlens/job.h"

#include <utility>

#include "core/error.h"
#include "postlens/internals.h"
#include "postlens/version.h"

namespace postlens::api {
namespace {

postlens::JobSettings settings_of(JobSettings settings) {
    constexpr int most_threads = 4096;  // as of the option --threads
    if (settings.threads < 0 || settings.threads > most_threads) {
        fail(postlens::ExitCode::wrong_arguments, "--threads: out of range (got {}; expected 0 to {})",
             settings.threads, most_threads);
    }
    postlens::JobSettings out{.threads = settings.threads};
    if (settings.watch) {
        out.watch = [watch = std::move(settings.watch)](const ProgressReport& r) {
            watch({r.step, r.share, r.seconds, r.seconds_left, r.ended});
        };
    }
    return out;
}

}  // namespace

Job::Job(JobSettings settings) {
    guarded(nullptr, [&] { impl_ = std::make_unique<Impl>(settings_of(std::move(settings))); });
}

Job::~Job() = default;

void Job::cancel() noexcept {
    impl_->job.cancel();
}

bool Job::cancelled() const noexcept {
    return impl_->job.cancelled();
}

Report run(const std::vector<std::string>& words, Job* job) {
    return guarded(job, [&] {
        Words all{};
        all.add(words);
        return run_words(all, nullptr, false).report;
    });
}

std::string version() {
    return fmt::format("{}.{}.{}", version_major, version_minor, version_patch);
}

}  // namespace postlens::api
