#include "chart/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace postlens {

std::vector<std::size_t> pareto_frontier(const std::vector<CostError>& points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::isfinite(points[i].seconds) && std::isfinite(points[i].error)) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return points[a].seconds != points[b].seconds ? points[a].seconds < points[b].seconds
                                                      : points[a].error < points[b].error;
    });
    std::vector<std::size_t> out;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order) {
        if (points[i].error < least) {
            least = points[i].error;
            out.push_back(i);
        }
    }
    return out;
}

std::optional<double> seconds_for_error(const std::vector<CostError>& curve, double error) {
    const std::vector<std::size_t> frontier = pareto_frontier(curve);
    for (std::size_t k = 0; k < frontier.size(); ++k) {
        const CostError& b = curve[frontier[k]];
        if (b.error > error) continue;
        if (b.error == error) return b.seconds;
        if (k == 0) return std::nullopt;
        const CostError& a = curve[frontier[k - 1]];
        const double t = std::log(a.error / error) / std::log(a.error / b.error);
        return a.seconds * std::pow(b.seconds / a.seconds, t);
    }
    return std::nullopt;
}

}  // namespace postlens
