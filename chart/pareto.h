// Pareto frontier of cost and error.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace postlens {

struct CostError {
    double seconds = 0, error = 0;  ///< both positive
};

/// Returns the indices of the Pareto-optimal points. A point is Pareto-optimal if no other point is better in
/// one of the two values (seconds and error) and at least as good in the other. They are sorted by rising
/// seconds, and therefore by falling error. Points with a nonfinite value are omitted. Of equal points only
/// the first is returned.
[[nodiscard]] std::vector<std::size_t> pareto_frontier(const std::vector<CostError>& points);

/// Returns the seconds at which a curve reaches `error`. They are interpolated between neighbours on the
/// curve's Pareto frontier, linearly in the logarithms. Empty if `error` is outside the range of the
/// frontier.
[[nodiscard]] std::optional<double> seconds_for_error(const std::vector<CostError>& curve, double error);

}  // namespace postlens
