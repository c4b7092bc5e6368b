// Selects the recorded instants from which another instant is reprojected.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

struct InstantShare {
    std::size_t instant = 0;
    double share = 1;
};

/// Returns the recorded instants before and after `time_s`, the earlier first, with the weights of linear
/// interpolation. If `time_s` lies before the first or after the last instant, returns only the nearest one.
/// `instants_s` must have at least one element and may have any order.
[[nodiscard]] std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s);

}  // namespace postlens
