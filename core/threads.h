// Parallel loops that give the same result for any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/job.h"

namespace postlens {

/// Calls chunk(begin, end) for ranges of at most `grain` indices (1 or more) that cover [0, count) once, in
/// any order. What parallel_for is made of; stops and throws as described there.
void parallel_chunks(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& chunk);

/// Calls body(i) for i in [0, count), in any order, each once. The work of one index must not depend on the
/// thread it runs on: that is what keeps results equal for any number of threads. What body throws is passed
/// on, after which no further work is begun; where several indices throw, any one of their exceptions. Stops
/// with Error(interrupted) when the current job is cancelled, which is looked for every `grain` indices:
/// `grain` times the work of one index should stay below 100 ms.
template <typename Body>
void parallel_for(std::size_t count, const Body& body, std::size_t grain = 1) {
    parallel_chunks(count, std::max<std::size_t>(grain, 1), [&body](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i != end; ++i) body(i);
    });
}

/// What make_in_order is made of: make(i) by any thread, `at_a_time` of them between the beginning of make(i)
/// and the end of end(i) at most, end(i) one at a time in order.
void run_in_order(std::size_t count, std::size_t at_a_time, const std::function<void(std::size_t)>& make,
                  const std::function<void(std::size_t)>& end);

/// Calls end(i, make(i)) for i in [0, count). make(i) is called for up to `at_a_time` (1 or more) indices at
/// once, by any thread, and may have parallel loops of its own; what one waits for, the other's work fills.
/// end is called in order and never twice at once. Stops and throws as parallel_for does.
template <typename Make, typename End>
void make_in_order(std::size_t count, std::size_t at_a_time, const Make& make, const End& end) {
    std::vector<std::optional<std::invoke_result_t<const Make&, std::size_t>>> made(count);
    run_in_order(
        count, std::max<std::size_t>(at_a_time, 1), [&](std::size_t i) { made[i].emplace(make(i)); },
        [&](std::size_t i) {
            end(i, *std::move(made[i]));
            made[i].reset();
        });
}

}  // namespace postlens
