// Parallel loops whose results do not depend on the number of threads.
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

/// Calls chunk(begin, end) for ranges of at most `grain` indices, in any order. Together they cover [0,
/// count) once. Exceptions and cancellation are handled as in parallel_for.
void parallel_chunks(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& chunk);

/// Calls body(i) once for each i in [0, count), in any order. If body throws, no further indices are started,
/// and one of the exceptions is rethrown.
///
/// Throws Error(interrupted) if the current job is cancelled. This is checked every `grain` indices, which
/// should take less than 100 ms.
template <typename Body>
void parallel_for(std::size_t count, const Body& body, std::size_t grain = 1) {
    parallel_chunks(count, std::max<std::size_t>(grain, 1), [&body](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i != end; ++i) body(i);
    });
}

/// Calls make(i), on any thread, and then end(i) for each i. The calls of end are made one at a time, in
/// order. At most `at_a_time` indices are in progress.
void run_in_order(std::size_t count, std::size_t at_a_time, const std::function<void(std::size_t)>& make,
                  const std::function<void(std::size_t)>& end);

/// Calls make(i) and end(i) for each i in [0, count). The calls of make are made one at a time, in order, and
/// so are those of end. While end(i) runs, make(i + 1) to make(i + ahead) may run.
void run_overlapped(std::size_t count, std::size_t ahead, const std::function<void(std::size_t)>& make,
                    const std::function<void(std::size_t)>& end);

/// Calls end(i, make(i)) for each i in [0, count). Up to `at_a_time` calls of make run at once, and may
/// contain parallel loops. Calls of end are made one at a time, in order.
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
