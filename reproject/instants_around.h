// Which recorded instants a moment is seen from.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

struct InstantShare {
    std::size_t instant = 0;
    double share = 1;
};

/// The two instants that a time lies between, the earlier first, with shares by nearness that add up to 1; or
/// the one next to it. `instants_s`: at least one, in any order.
[[nodiscard]] std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s);

}  // namespace postlens
