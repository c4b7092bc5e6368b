// Finds the Pareto frontier of cost (in seconds) and error.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace postlens {

struct CostError {
    double seconds = 0, error = 0;  ///< both positive
};

/// Returns the indices of the Pareto-optimal points (seconds and error), by rising seconds. No other point is
/// better in one value without being worse in the other.
///
/// Points that are not finite are omitted. Of equal points, the first is returned.
[[nodiscard]] std::vector<std::size_t> pareto_frontier(const std::vector<CostError>& points);

/// Returns the time, in seconds, after which the error of a method falls to `error`, or nothing if `error` is
/// outside the measured range. It is interpolated on the Pareto frontier of the measurements in `curve`,
/// linearly in the logarithms of error and time.
[[nodiscard]] std::optional<double> seconds_for_error(const std::vector<CostError>& curve, double error);

}  // namespace postlens
