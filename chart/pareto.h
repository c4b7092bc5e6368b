// Which points of a chart are worth having.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace postlens {

struct CostError {
    double seconds = 0, error = 0;  ///< both more than 0
};

/// Indices of the points that no other one beats in one figure without losing in the other, by rising cost
/// and falling error. Points with a NaN or nothing finite are left out; of equal ones the first is kept.
[[nodiscard]] std::vector<std::size_t> pareto_frontier(const std::vector<CostError>& points);

/// Seconds at which a curve of points reaches `error`, linear in both logarithms between neighbours of its
/// frontier; beyond its ends nothing.
[[nodiscard]] std::optional<double> seconds_for_error(const std::vector<CostError>& curve, double error);

}  // namespace postlens
