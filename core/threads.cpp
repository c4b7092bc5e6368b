#include "core/threads.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

namespace postlens {
namespace {
tbb::task_arena* g_arena = nullptr;
int g_threads = 0;
}  // namespace

struct ThreadLimit::Impl {
    explicit Impl(int threads)
        : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
          arena(threads),
          previous_arena(g_arena),
          previous_threads(g_threads) {}
    tbb::global_control control;
    tbb::task_arena arena;
    tbb::task_arena* previous_arena;
    int previous_threads;
};

ThreadLimit::ThreadLimit(int threads) {
    const int resolved = threads > 0 ? threads : tbb::info::default_concurrency();
    impl_ = std::make_unique<Impl>(resolved);
    g_arena = &impl_->arena;
    g_threads = resolved;
}

ThreadLimit::~ThreadLimit() {
    g_arena = impl_->previous_arena;
    g_threads = impl_->previous_threads;
}

int thread_count() {
    return g_threads > 0 ? g_threads : tbb::info::default_concurrency();
}

tbb::task_arena* current_arena() {
    return g_arena;
}

}  // namespace postlens
