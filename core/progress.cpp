#include "core/progress.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <memory>
#include <string_view>
#include <unistd.h>
#include <utility>

namespace postlens {
namespace {

/// Returns true if stderr is a terminal that supports "erase to the end of the line", which the progress bar
/// needs.
bool stderr_takes_a_bar() {
    const char* terminal = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class Bar {
  public:
    void show(const ProgressReport& report) {
        if (report.ended) {
            if (drawn_) std::fputs("\r\033[K", stderr);
            drawn_ = false;
        } else if (report.seconds >= 1) {
            draw(report);
        }
    }

  private:
    void draw(const ProgressReport& report) {
        constexpr int bar_columns = 30;
        const int filled = static_cast<int>(report.share * bar_columns);
        // Rounds the percentage down, so that 100 % appears only at the end. A single call writes the bar, so
        // that no other output interrupts it.
        const std::string line = fmt::format(
            "\r{} [{:=<{}}{: <{}}] {:3} %  {} left\033[K", report.step, "", filled, "", bar_columns - filled,
            static_cast<int>(report.share * 100), duration_text(report.seconds_left));
        std::fwrite(line.data(), 1, line.size(), stderr);
        std::fflush(stderr);
        drawn_ = true;
    }

    bool drawn_ = false;
};

}  // namespace

std::string duration_text(double duration_s) {
    // Limits durations to 1000 days, because much larger values do not fit the integer.
    constexpr double longest_s = 1000 * 86400.0;
    const auto seconds =
        static_cast<std::int64_t>(duration_s > 0 ? std::min(duration_s, longest_s) + 0.5 : 0);
    if (seconds < 60) return fmt::format("{} s", seconds);
    if (seconds < 3600) return fmt::format("{} min {:02} s", seconds / 60, seconds % 60);
    return fmt::format("{} h {:02} min", seconds / 3600, seconds / 60 % 60);
}

std::function<void(const ProgressReport&)> terminal_bar() {
    if (!stderr_takes_a_bar()) return {};
    return [bar = std::make_shared<Bar>()](const ProgressReport& report) { bar->show(report); };
}

Progress::Progress(std::string step, std::uint64_t total)
    : step_(std::move(step)), total_(std::max<std::uint64_t>(total, 1)), start_(Clock::now()) {
    Job* job = &Job::current();
    while (job != nullptr && !job->watch_) job = job->outer_;
    if (job != nullptr && !job->reporting_.exchange(true)) watched_ = job;
}

Progress::~Progress() {
    if (watched_ == nullptr) return;
    if (reported_) report(seconds_since(start_), true);
    watched_->reporting_ = false;
}

void Progress::advance(std::uint64_t units) {
    if (watched_ == nullptr) return;
    done_.fetch_add(units, std::memory_order_relaxed);
    const double elapsed_s = seconds_since(start_);
    const auto elapsed_ms = static_cast<std::int64_t>(elapsed_s * 1000);
    auto due = next_report_ms_.load(std::memory_order_relaxed);
    // Several threads may find that a progress report is due. Only the one that succeeds in setting the time
    // of the next report makes it.
    if (elapsed_ms >= due && next_report_ms_.compare_exchange_strong(due, elapsed_ms + 100)) {
        report(elapsed_s, false);
    }
}

void Progress::report(double elapsed_s, bool ended) {
    const std::lock_guard lock(reporting_);
    const std::uint64_t done = done_.load(std::memory_order_relaxed);
    if (done == 0) return;
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    watched_->watch_({step_, share, elapsed_s, elapsed_s * (1 - share) / share, ended});
    reported_ = true;
}

}  // namespace postlens
