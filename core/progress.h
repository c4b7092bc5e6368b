// Work that takes a while: it can be watched and it can be interrupted.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace postlens {

/// Makes SIGINT, SIGTERM and SIGHUP set a flag instead of ending the process; a signal that the process was
/// started to ignore (nohup, a background job of a script) stays ignored. A second signal ends the process by
/// its default action, after removing what OutputFile has not yet committed.
void install_interrupt_handler();

/// True once a signal came. Safe from any thread; costs one relaxed load of an atomic.
[[nodiscard]] bool interrupted();

/// Throws Error(interrupted) once a signal came. Long loops call it at least every 100 ms.
void throw_if_interrupted();

/// For tests: sets or clears the flag as a signal would.
void set_interrupted(bool value);

/// "8 s", "3 min 05 s" or "2 h 07 min"; negative and undefined durations count as zero.
[[nodiscard]] std::string duration_text(double duration_s);

/// A bar with the time left on stderr, shown only on a terminal, after a second, and unless `quiet`.
/// `advance` may be called from any thread.
class Progress {
  public:
    /// `total`: how many steps `advance` will count up to.
    Progress(std::string label, std::uint64_t total, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    Progress(Progress&&) = delete;
    Progress& operator=(Progress&&) = delete;

    void advance(std::uint64_t steps = 1);

  private:
    void draw(double elapsed_s, std::uint64_t done);

    std::string label_;
    std::uint64_t total_;
    bool enabled_;
    std::chrono::steady_clock::time_point start_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> next_draw_ms_{1000};
    std::atomic<bool> drawn_{false};
};

}  // namespace postlens
