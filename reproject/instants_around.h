// The recorded instants from which an instant is reprojected.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

struct InstantShare {
    std::size_t instant = 0;
    double share = 1;
};

/// The recorded instants before and after `time_s`, the earlier first, with the weights of linear
/// interpolation. If `time_s` is before the first or after the last instant, only the nearest instant.
/// `instants_s`: at least one, in any order.
[[nodiscard]] std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s);

}  // namespace postlens
