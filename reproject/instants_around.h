// Selects the recorded instants from which the image at another instant is made.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

struct InstantShare {
    std::size_t instant = 0;
    double share = 1;
};

/// Returns the recorded instants just before and just after `time_s`, in this order. Their shares are the
/// weights of linear interpolation in time. If `time_s` lies before the first or after the last recorded
/// instant, returns only the nearest one. `instants_s` must have at least one element and may have any order.
[[nodiscard]] std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s);

}  // namespace postlens
