// Pareto frontier of cost and error.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace postlens {

struct CostError {
    double seconds = 0, error = 0;  ///< both positive
};

/// Indices of the Pareto-optimal points: no other point is better in one figure and at least as good in the
/// other. Sorted by rising seconds, that is by falling error. Points with a nonfinite figure are omitted; of
/// equal points the first is kept.
[[nodiscard]] std::vector<std::size_t> pareto_frontier(const std::vector<CostError>& points);

/// Seconds at which a curve reaches `error`, by log-log interpolation between neighbours on its Pareto
/// frontier. Empty if `error` lies outside the range of the frontier.
[[nodiscard]] std::optional<double> seconds_for_error(const std::vector<CostError>& curve, double error);

}  // namespace postlens
