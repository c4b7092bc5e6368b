// Finds the Pareto frontier of cost (in seconds) and error.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace postlens {

struct CostError {
    double seconds = 0, error = 0;  ///< both positive
};

/// Returns the indices of the Pareto-optimal points, sorted by rising seconds. A point is omitted if another
/// point is better in one of the two values (seconds and error) and at least as good in the other. Points
/// with a value that is not finite are omitted. Of several equal points, only the first is returned.
[[nodiscard]] std::vector<std::size_t> pareto_frontier(const std::vector<CostError>& points);

/// Returns the seconds at which a curve reaches `error`. The value is interpolated between neighbouring
/// points of the curve's Pareto frontier, linearly in the logarithms of both values. Empty if `error` is
/// outside the range of the frontier.
[[nodiscard]] std::optional<double> seconds_for_error(const std::vector<CostError>& curve, double error);

}  // namespace postlens
