#include "core/signals.h"

#include <atomic>
#include <csignal>

#include "core/files/output_file.h"

namespace postlens {
namespace {

std::atomic<Job*> job_to_cancel{nullptr};
std::atomic<bool> had_a_signal{false};
std::atomic<int> first_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<Job*>::is_always_lock_free,
              "a signal handler may set only lock-free flags");

extern "C" void on_signal(int signal) {
    if (had_a_signal.exchange(true)) {
        remove_all_temporaries();
        ::signal(signal, SIG_DFL);
        ::raise(signal);
    } else {
        first_signal = signal;
        job_to_cancel.load()->cancel();
    }
}

}  // namespace

void cancel_on_signals(Job& job) {
    job_to_cancel = &job;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
        struct sigaction action {};
        if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = on_signal;
        action.sa_flags = SA_RESTART;  // otherwise reads and writes inside libraries fail with EINTR
        ::sigemptyset(&action.sa_mask);
        ::sigaction(signal, &action, nullptr);
    }
}

bool is_asked_to_requeue() {
    return first_signal == SIGTERM || first_signal == SIGUSR1;
}

}  // namespace postlens
