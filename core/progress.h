// Measures the progress of the steps of a job, and draws the progress bar.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "core/job.h"

namespace postlens {

/// Formats a duration as "8 s", "3 min 05 s" or "2 h 07 min". Negative and NaN durations count as zero.
[[nodiscard]] std::string duration_text(double duration_s);

/// Returns a watcher (JobSettings::watch) that draws a bar on stderr after one second. It is empty if stderr
/// is not a terminal that can show the bar.
[[nodiscard]] std::function<void(const ProgressReport&)> terminal_bar();

/// A step of the current job. It reports its progress to the job's watcher (a callback). A step that begins
/// within another step does not report.
class Progress {
  public:
    /// `total` is the number of units of work (for example rows) in this step.
    Progress(std::string step, std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    Progress(Progress&&) = delete;
    Progress& operator=(Progress&&) = delete;

    /// Adds completed units of work. Thread-safe.
    void advance(std::uint64_t units = 1);

  private:
    void report(double elapsed_s, bool ended);

    std::string step_;
    std::uint64_t total_;
    Job* watched_ = nullptr;  ///< job whose watcher receives the reports; null if nothing is reported
    std::chrono::steady_clock::time_point start_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> next_report_ms_{100};
    std::mutex reporting_;
    bool reported_ = false;
};

}  // namespace postlens
