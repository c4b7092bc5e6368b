// Selects the recorded instants of a moving scene from which the image at another instant is interpolated.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

struct InstantShare {
    std::size_t instant = 0;
    double share = 1;
};

/// Returns the recorded instants just before and just after `time_s`, with their weights for linear
/// interpolation. Before the first or after the last recorded instant, returns only the nearest one.
/// `instants_s` must not be empty, but may be unsorted.
[[nodiscard]] std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s);

}  // namespace postlens
