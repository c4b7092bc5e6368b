// Selects the recorded instants of a moving scene from which the image at another instant is interpolated.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

struct InstantShare {
    std::size_t instant = 0;
    double share = 1;
};

/// Returns the recorded instants just before and after `time_s`, with their weights for linear interpolation.
/// Outside the recorded interval, returns only the nearest instant. `instants_s` (in any order) must not be
/// empty.
[[nodiscard]] std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s);

}  // namespace postlens
