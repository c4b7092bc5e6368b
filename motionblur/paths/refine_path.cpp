#include "motionblur/paths/refine_path.h"

#include <algorithm>
#include <array>
#include <ceres/ceres.h>
#include <cmath>
#include <limits>

namespace postlens {
namespace {

using glm::dvec2;

/// To save time, the first fit of a spline uses only this number of data points per segment. Each later fit
/// also uses the data points at which the error of the previous fit is largest.
constexpr std::size_t points_per_segment = 40;
constexpr int most_rounds = 6;

/// Residual of a least-squares fit: the difference between a data point and the curve's position at the
/// point's time, divided by the tolerance.
struct Distance {
    double time_s;
    dvec2 at_px;
    double inverse_tolerance;

    template <typename T>
    bool operator()(const T* from, const T* out, const T* in, const T* to, const T* begin_s, const T* end_s,
                    T* residual) const {
        const T u = (T(time_s) - *begin_s) / (*end_s - *begin_s), v = T(1) - u;
        const std::array<T, 4> basis{v * v * v, T(3) * v * v * u, T(3) * v * u * u, u * u * u};
        for (int axis = 0; axis < 2; ++axis) {
            const T place = basis[0] * from[axis] + basis[1] * (from[axis] + out[axis]) +
                            basis[2] * (to[axis] + in[axis]) + basis[3] * to[axis];
            residual[axis] = (place - T(at_px[axis])) * T(inverse_tolerance);
        }
        return true;
    }
};

/// Loss function: quadratic up to the tolerance, and of fourth power above it.
class FourthPower : public ceres::LossFunction {
  public:
    void Evaluate(double s,
                  double* out) const override {  // NOLINT(readability-identifier-naming): Ceres' name
        out[0] = s <= 1 ? s : 0.5 * (s * s + 1);
        out[1] = s <= 1 ? 1 : s;
        out[2] = s <= 1 ? 0 : 1;
    }
};

std::size_t segment_of(const std::vector<PathKnot>& knots, double time_s) {
    const auto after = std::upper_bound(knots.begin() + 1, knots.end() - 1, time_s,
                                        [](double t, const PathKnot& k) { return t < k.time_s; });
    return static_cast<std::size_t>(after - knots.begin()) - 1;
}

enum class Freedom { places, places_and_times };

void solve(std::vector<PathKnot>& knots, std::span<const PathPoint> points,
           const std::vector<std::size_t>& chosen, double tolerance_px, Freedom freedom, bool fourth_power) {
    ceres::Problem::Options ownership;
    FourthPower loss;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    for (const std::size_t i : chosen) {
        const std::size_t s = segment_of(knots, points[i].time_s);
        PathKnot &a = knots[s], &b = knots[s + 1];
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Distance, 2, 2, 2, 2, 2, 1, 1>(
                                     new Distance{points[i].time_s, points[i].at_px, 1 / tolerance_px}),
                                 fourth_power ? &loss : nullptr, &a.at_px.x, &a.out_px.x, &b.in_px.x,
                                 &b.at_px.x, &a.time_s, &b.time_s);
    }
    for (std::size_t k = 0; k < knots.size(); ++k) {
        double* time_s = &knots[k].time_s;
        if (!problem.HasParameterBlock(time_s)) continue;
        if (freedom == Freedom::places || k == 0 || k + 1 == knots.size()) {
            problem.SetParameterBlockConstant(time_s);
            continue;
        }
        // The bounds keep the times of neighbouring spline knots apart.
        constexpr double leeway = 0.3;
        problem.SetParameterLowerBound(time_s, 0, *time_s - leeway * (*time_s - knots[k - 1].time_s));
        problem.SetParameterUpperBound(time_s, 0, *time_s + leeway * (knots[k + 1].time_s - *time_s));
    }
    ceres::Solver::Options options;
    options.num_threads = 1;  // the same result on every machine
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.max_num_iterations = 12;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = 1e-6;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
}

/// Returns the position at an instant, interpolated linearly between the points.
dvec2 place_at(std::span<const PathPoint> points, double time_s) {
    const auto after = std::upper_bound(points.begin() + 1, points.end() - 1, time_s,
                                        [](double t, const PathPoint& p) { return t < p.time_s; });
    const PathPoint &a = *(after - 1), &b = *after;
    const double u = (time_s - a.time_s) / (b.time_s - a.time_s);
    return (1 - u) * a.at_px + u * b.at_px;
}

bool is_path(const std::vector<PathKnot>& knots) {
    for (std::size_t i = 0; i < knots.size(); ++i) {
        if (i > 0 && !(knots[i].time_s > knots[i - 1].time_s)) return false;
        for (const dvec2& p : {knots[i].at_px, knots[i].in_px, knots[i].out_px}) {
            if (!(std::abs(p.x) <= largest_path_coordinate_px && std::abs(p.y) <= largest_path_coordinate_px))
                return false;
        }
    }
    return true;
}

}  // namespace

double greatest_error_px(const ScreenPath& path, std::span<const PathPoint> points) {
    double worst = 0;
    for (const PathPoint& p : points) worst = std::max(worst, glm::distance(path.at(p.time_s), p.at_px));
    return worst;
}

std::vector<PathKnot> refine_path(std::span<const PathPoint> points, const std::vector<double>& times_s,
                                  double tolerance_px) {
    // Times are scaled to 0..1, so that the solver's steps do not depend on the duration.
    const double begin_s = points.front().time_s, span_s = points.back().time_s - begin_s;
    std::vector<PathPoint> scaled;
    scaled.reserve(points.size());
    for (const PathPoint& p : points) scaled.push_back({(p.time_s - begin_s) / span_s, p.at_px});
    std::vector<PathKnot> knots;
    for (const double t : times_s) {
        const double share = (t - begin_s) / span_s;
        knots.push_back({share, place_at(scaled, share), {}, {}});
    }
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        knots[i].out_px = (knots[i + 1].at_px - knots[i].at_px) / 3.0;
        knots[i + 1].in_px = -knots[i].out_px;
    }
    std::vector<std::size_t> chosen;
    const std::size_t count = std::min(scaled.size(), points_per_segment * (knots.size() - 1));
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(i * (scaled.size() - 1) / (count - 1));

    std::vector<PathKnot> best = knots;
    double best_px = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
        solve(knots, scaled, chosen, tolerance_px, round == 0 ? Freedom::places : Freedom::places_and_times,
              round > 1);
        if (!is_path(knots)) break;
        const ScreenPath path(PathKind::bezier, knots, "--fit-paths");
        // The path was fitted to a subset of the points, `chosen`. Finds, for each segment of the path, the
        // point that lies farthest from it. If its distance exceeds the tolerance, it is added to `chosen`
        // for the next round.
        std::vector<std::size_t> worst(knots.size() - 1, 0);
        std::vector<double> worst_px(knots.size() - 1, 0.0);
        for (std::size_t i = 0; i < scaled.size(); ++i) {
            const std::size_t s = segment_of(knots, scaled[i].time_s);
            const double off_px = glm::distance(path.at(scaled[i].time_s), scaled[i].at_px);
            if (off_px > worst_px[s]) {
                worst_px[s] = off_px;
                worst[s] = i;
            }
        }
        const double error_px = *std::max_element(worst_px.begin(), worst_px.end());
        const double gain = error_px / best_px;
        if (error_px < best_px) {
            best = knots;
            best_px = error_px;
        }
        if (error_px <= tolerance_px || (round >= 2 && (error_px > 8 * tolerance_px || gain > 0.995))) break;
        if (chosen.size() < scaled.size()) {
            for (std::size_t s = 0; s < worst.size(); ++s)
                if (worst_px[s] > tolerance_px) chosen.push_back(worst[s]);
        }
    }
    for (PathKnot& k : best) k.time_s = begin_s + span_s * k.time_s;
    best.front().time_s = begin_s;
    best.back().time_s = points.back().time_s;
    return best;
}

}  // namespace postlens
