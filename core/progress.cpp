#include "core/progress.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <unistd.h>
#include <utility>

#include "core/error.h"
#include "core/output_file.h"

namespace postlens {
namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set only a lock-free flag");

extern "C" void on_signal(int signal) {
    if (g_interrupted.exchange(true)) {
        remove_all_temporaries();
        ::signal(signal, SIG_DFL);
        ::raise(signal);
    }
}

/// The bar ends with the control sequence "erase to the end of the line".
bool stderr_takes_a_bar() {
    const char* terminal = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

}  // namespace

void install_interrupt_handler() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action {};
        if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = on_signal;
        action.sa_flags = SA_RESTART;  // or reads and writes inside libraries would fail with EINTR
        ::sigemptyset(&action.sa_mask);
        ::sigaction(signal, &action, nullptr);
    }
}

bool interrupted() {
    return g_interrupted.load(std::memory_order_relaxed);
}

void throw_if_interrupted() {
    if (interrupted()) fail(ExitCode::interrupted, "interrupted; unfinished output was removed");
}

void set_interrupted(bool value) {
    g_interrupted = value;
}

std::string duration_text(double duration_s) {
    // The bound keeps the conversion defined; a thousand days is as good as any longer time.
    constexpr double longest_s = 1000 * 86400.0;
    const auto seconds =
        static_cast<std::int64_t>(duration_s > 0 ? std::min(duration_s, longest_s) + 0.5 : 0);
    if (seconds < 60) return fmt::format("{} s", seconds);
    if (seconds < 3600) return fmt::format("{} min {:02} s", seconds / 60, seconds % 60);
    return fmt::format("{} h {:02} min", seconds / 3600, seconds / 60 % 60);
}

Progress::Progress(std::string label, std::uint64_t total, bool quiet)
    : label_(std::move(label)),
      total_(std::max<std::uint64_t>(total, 1)),
      enabled_(!quiet && stderr_takes_a_bar()),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::advance(std::uint64_t steps) {
    if (!enabled_) return;
    const std::uint64_t done = done_.fetch_add(steps, std::memory_order_relaxed) + steps;
    const auto elapsed = std::chrono::steady_clock::now() - start_;
    const auto elapsed_ms = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
    auto due = next_draw_ms_.load(std::memory_order_relaxed);
    // One thread wins each redraw; the others go on working.
    if (elapsed_ms >= due && next_draw_ms_.compare_exchange_strong(due, elapsed_ms + 100)) {
        draw(static_cast<double>(elapsed_ms) / 1000.0, done);
    }
}

void Progress::draw(double elapsed_s, std::uint64_t done) {
    if (done == 0) return;
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    const double left_s = elapsed_s * (1 - share) / share;
    constexpr int bar_columns = 30;
    const int filled = static_cast<int>(share * bar_columns);
    // Rounded down, so that 100 % says that the work is done; one write, so that two threads' lines never
    // mix.
    const std::string line =
        fmt::format("\r{} [{:=<{}}{: <{}}] {:3} %  {} left\033[K", label_, "", filled, "",
                    bar_columns - filled, static_cast<int>(share * 100), duration_text(left_s));
    std::fwrite(line.data(), 1, line.size(), stderr);
    std::fflush(stderr);
    drawn_ = true;
}

}  // namespace postlens
