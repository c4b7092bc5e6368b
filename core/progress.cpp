#include "core/progress.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <utility>

#include "core/error.h"

namespace postlens {
namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set only a lock-free flag");

void on_signal(int signal) {
    if (g_interrupted.exchange(true)) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
}

}  // namespace

void install_interrupt_handler() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, on_signal);
}

bool interrupted() {
    return g_interrupted.load(std::memory_order_relaxed);
}

void throw_if_interrupted() {
    if (interrupted()) throw Error(ExitCode::interrupted, "interrupted, nothing was written");
}

void set_interrupted(bool value) {
    g_interrupted = value;
}

Progress::Progress(std::string label, std::uint64_t total, bool quiet)
    : label_(std::move(label)),
      total_(std::max<std::uint64_t>(total, 1)),
      enabled_(!quiet && ::isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::advance(std::uint64_t steps) {
    const std::uint64_t done = done_.fetch_add(steps, std::memory_order_relaxed) + steps;
    if (!enabled_) return;
    const auto elapsed = std::chrono::steady_clock::now() - start_;
    const auto elapsed_ms = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
    auto due = next_draw_ms_.load();
    // One thread wins each redraw; the others go on working.
    if (elapsed_ms >= due && next_draw_ms_.compare_exchange_strong(due, elapsed_ms + 100)) {
        draw(static_cast<double>(elapsed_ms) / 1000.0, done);
    }
}

void Progress::draw(double elapsed_s, std::uint64_t done) {
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    const double left_s = share > 0 ? elapsed_s * (1 - share) / share : 0;
    constexpr int width = 30;
    const int filled = static_cast<int>(share * width);
    fmt::print(stderr, "\r{} [{:=<{}}{:{}}] {:3.0f} %  {:.0f} s left\033[K", label_, "", filled, "",
               width - filled, share * 100, left_s);
    std::fflush(stderr);
    drawn_ = true;
}

}  // namespace postlens
