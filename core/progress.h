// How far a step of a job is, and the bar that shows it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "core/job.h"

namespace postlens {

/// "8 s", "3 min 05 s" or "2 h 07 min"; negative and undefined durations count as zero.
[[nodiscard]] std::string duration_text(double duration_s);

/// A watcher that draws a bar with the time left on stderr, from a step's first second on. Empty where stderr
/// is no terminal that could show it.
[[nodiscard]] std::function<void(const ProgressReport&)> terminal_bar();

/// A step of the current job. Tells the job's watcher how far it is, unless it is part of another step.
class Progress {
  public:
    /// `total`: how many units `advance` will count up to.
    Progress(std::string step, std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    Progress(Progress&&) = delete;
    Progress& operator=(Progress&&) = delete;

    /// From any thread.
    void advance(std::uint64_t units = 1);

  private:
    void report(double elapsed_s, bool ended);

    std::string step_;
    std::uint64_t total_;
    Job* watched_ = nullptr;  ///< whose watcher is told; absent: nobody
    std::chrono::steady_clock::time_point start_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> next_report_ms_{100};
    std::mutex reporting_;
    bool reported_ = false;
};

}  // namespace postlens
