#include "lens/fits/thin_lens_fit.h"

#include <algorithm>
#include <array>
#include <ceres/ceres.h>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "core/units.h"

namespace postlens {
namespace {

/// Returns a focal length for lenses whose focal length the measurements do not determine. It is 50 mm, but
/// at most half the focus distance, because a lens cannot focus nearer than its focal length.
double example_focal_length_mm(double inverse_focus_per_m) {
    constexpr double usual_mm = 50;
    return inverse_focus_per_m > 0 ? std::min(usual_mm, 0.5 / inverse_focus_per_m / metres_per_mm) : usual_mm;
}

/// Residual of the fit of a thin lens to measured circles of confusion. If a thin lens is focused at the
/// distance 1/q, a point at the depth z has a circle of the diameter K |q - 1/z|. The residual is this
/// diameter minus the measured diameter.
struct Difference {
    double inverse_depth, coc_mm;
    template <typename T>
    bool operator()(const T* log_focal_mm, const T* log_f_number, const T* inverse_focus, T* residual) const {
        using std::exp;
        const T F_m = exp(log_focal_mm[0]) * metres_per_mm;
        // The factor K is F^2 / (n (1 - F q)), with the focal length F, the f-number n and the inverse focus
        // distance q.
        const T K =
            exp(T(2) * log_focal_mm[0] - log_f_number[0]) * metres_per_mm / (T(1) - F_m * inverse_focus[0]);
        const T away = inverse_focus[0] - T(inverse_depth);
        residual[0] = K * (away < T(0) ? -away : away) - T(coc_mm);
        return true;
    }
};

/// Result of fitting a thin lens to measured circles of confusion. At the inverse depth x, the fitted
/// diameter of a circle is K |q - x|. K is in mm times m, and q, the inverse focus distance, is in 1/m.
/// `error` is the sum of the squared residuals, in mm^2.
struct LineFit {
    double K = 0, q = 0, error = std::numeric_limits<double>::infinity();
};

LineFit fit_line(std::vector<CocPair> pairs) {
    std::sort(pairs.begin(), pairs.end(),
              [](const CocPair& a, const CocPair& b) { return a.distance_m > b.distance_m; });
    LineFit best;
    // Fits a line to the diameters of circles of confusion over the inverse depth. A diameter does not tell
    // whether its point lies behind the focus or in front of it, so all possibilities are tried. The first
    // `behind` measurements, sorted from far to near, count as behind the focus.
    for (std::size_t behind = 0; behind <= pairs.size(); ++behind) {
        // Fits the factor K and the inverse focus distance q: at the inverse depth x, the signed diameter of
        // a circle of confusion is K (q - x).
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            // Diameters of circles in front of the focus, where x > q, count as negative, so that they are a
            // linear function of x too.
            const double x = 1 / pairs[i].distance_m, y = i < behind ? pairs[i].coc_mm : -pairs[i].coc_mm;
            n += 1;
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
        }
        const double K = -(n * sxy - sx * sy) / (n * sxx - sx * sx);
        const double q = (sy / n + K * sx / n) / K;
        if (!(K > 0) || !(q >= 0)) continue;
        double error = 0;
        for (const CocPair& pair : pairs) {
            const double difference = K * std::abs(q - 1 / pair.distance_m) - pair.coc_mm;
            error += difference * difference;
        }
        if (error < best.error) best = {K, q, error};
    }
    return best;
}

void check(std::span<const CocPair> pairs, const ThinLensFitRequest& request) {
    for (const auto& given : {request.focal_length_mm, request.f_number}) {
        if (given && !(*given > 0 && std::isfinite(*given))) {
            fail(ExitCode::wrong_arguments,
                 "what is known of the lens is out of range (got {}; expected more than 0 and finite)",
                 *given);
        }
    }
    const auto [nearest, farthest] =
        std::minmax_element(pairs.begin(), pairs.end(),
                            [](const CocPair& a, const CocPair& b) { return a.distance_m < b.distance_m; });
    if (pairs.size() < 2 || nearest->distance_m == farthest->distance_m) {
        fail(ExitCode::invalid_input,
             "pairs tell nothing of a lens (got {} at one distance; expected two distances or more)",
             pairs.size());
    }
}

constexpr std::array<const char*, 3> names = {"F", "n", "s"};

/// Returns the condition number of the fit, which tells how much errors of the data are amplified. The
/// columns of the Jacobian `rows` are derivatives with respect to log F, log n and 1/s. Only those with the
/// indices `free` are used. `weak` receives the combination of parameters that the data determine least
/// precisely.
double condition_of(const std::vector<std::array<double, 3>>& rows, const std::vector<int>& free,
                    Eigen::VectorXd& weak) {
    Eigen::MatrixXd J(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(free.size()));
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
        for (Eigen::Index k = 0; k < J.cols(); ++k) {
            J(i, k) = rows[static_cast<std::size_t>(i)]
                          [static_cast<std::size_t>(free[static_cast<std::size_t>(k)])];
        }
    }
    for (Eigen::Index k = 0; k < J.cols(); ++k) {
        // Scales the Jacobian's columns to length 1, so that the condition number does not depend on the
        // parameters' units.
        const double norm = J.col(k).norm();
        if (norm > 0) J.col(k) /= norm;
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinV);
    const Eigen::VectorXd& sizes = svd.singularValues();
    weak = svd.matrixV().col(svd.matrixV().cols() - 1);
    const double least = J.rows() < J.cols() ? 0 : sizes(sizes.size() - 1);
    return least > 0 ? sizes(0) / least : std::numeric_limits<double>::infinity();
}

}  // namespace

ThinLensFit fit_thin_lens(std::span<const CocPair> pairs, const ThinLensFitRequest& request) {
    check(pairs, request);
    const LineFit line = fit_line({pairs.begin(), pairs.end()});
    if (!std::isfinite(line.error)) {
        fail(ExitCode::invalid_input,
             "pairs are those of no lens (got circles of confusion that do not grow away from any focus)");
    }
    // The diameters of circles of confusion determine the inverse focus distance q and the factor K = F^2 /
    // (n (1 - F q)). K contains two unknowns, the focal length F and the f-number n. Therefore, one of these
    // two must be known or assumed.
    ThinLensFit out;
    const bool both_free = !request.focal_length_mm && !request.f_number;
    double F_mm = request.focal_length_mm.value_or(example_focal_length_mm(line.q)), n = 1;
    if (!request.focal_length_mm && request.f_number) {
        const double b = line.K * *request.f_number * line.q * metres_per_mm;
        F_mm = (-b + std::sqrt(b * b + 4 * metres_per_mm * line.K * *request.f_number)) / (2 * metres_per_mm);
    }
    double q = std::min(line.q, 0.999 / (F_mm * metres_per_mm));
    n = request.f_number.value_or(F_mm * F_mm * metres_per_mm / (line.K * (1 - F_mm * metres_per_mm * q)));

    double log_focal = std::log(F_mm), log_stop = std::log(n);
    ceres::Problem problem;
    for (const CocPair& pair : pairs) {
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Difference, 1, 1, 1, 1>(
                                     new Difference{1 / pair.distance_m, pair.coc_mm}),
                                 nullptr, &log_focal, &log_stop, &q);
    }
    problem.SetParameterLowerBound(&q, 0, 0);
    std::vector<int> free = {2};
    if (request.focal_length_mm || both_free) {
        problem.SetParameterBlockConstant(&log_focal);
    } else {
        free.insert(free.begin(), 0);
    }
    if (request.f_number) {
        problem.SetParameterBlockConstant(&log_stop);
    } else {
        free.insert(free.end() - 1, 1);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    options.function_tolerance = options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-16;
    options.max_num_iterations = 200;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable())
        fail(ExitCode::invalid_input, "pairs are those of no lens (the fit found none)");

    std::vector<std::array<double, 3>> rows(pairs.size());
    double error = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const ceres::AutoDiffCostFunction<Difference, 1, 1, 1, 1> cost(
            new Difference{1 / pairs[i].distance_m, pairs[i].coc_mm});
        const std::array<const double*, 3> parameters = {&log_focal, &log_stop, &q};
        std::array<double*, 3> jacobian = {&rows[i][0], &rows[i][1], &rows[i][2]};
        double residual = 0;
        cost.Evaluate(parameters.data(), &residual, jacobian.data());
        error += residual * residual;
    }
    F_mm = std::exp(log_focal);
    n = std::exp(log_stop);
    out.focal_length_mm.value = F_mm;
    out.f_number.value = n;
    out.focus_distance_m.value = 1 / q;
    out.rms_mm = std::sqrt(error / static_cast<double>(pairs.size()));

    Eigen::VectorXd weak;
    out.condition = condition_of(rows, both_free ? std::vector{0, 1, 2} : free, weak);
    constexpr double tells_nothing = 1e6, tells_little = 1e3;
    if (both_free) {
        out.doubts.push_back(
            fmt::format("F and n cannot be told apart: circles of confusion depend on F^2/(n (s - F)) and s "
                        "alone (condition {:.3g}); F, n "
                        "are for F = {:.4g} mm, any other F has its n; state one of them",
                        out.condition, F_mm));
        out.condition = condition_of(rows, free, weak);
    }
    const bool known = out.condition < tells_nothing;
    if (out.condition > tells_little) {
        std::string which;
        for (std::size_t k = 0; k < free.size(); ++k) {
            if (std::abs(weak(static_cast<Eigen::Index>(k))) < 0.1) continue;
            which += (which.empty() ? "" : " and ") + std::string(names[static_cast<std::size_t>(free[k])]);
        }
        out.doubts.push_back(fmt::format("{} {} told apart: the depths differ too little (condition {:.3g})",
                                         which, known ? "are barely" : "cannot be", out.condition));
    }
    if (pairs.size() <= free.size()) {
        out.doubts.emplace_back(
            "no more pairs than numbers: the fit is exact and says nothing of its own error");
        return out;
    }
    if (!known) return out;
    // Covariance of the fitted parameters: residual variance times (J^T J)^-1, with the Jacobian J.
    Eigen::MatrixXd J(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(free.size()));
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
        for (Eigen::Index k = 0; k < J.cols(); ++k) {
            J(i, k) = rows[static_cast<std::size_t>(i)]
                          [static_cast<std::size_t>(free[static_cast<std::size_t>(k)])];
        }
    }
    const double variance = error / static_cast<double>(pairs.size() - free.size());
    const Eigen::MatrixXd covariance = variance * (J.transpose() * J).inverse();
    for (std::size_t k = 0; k < free.size(); ++k) {
        const double sigma =
            std::sqrt(covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
        if (free[k] == 0) out.focal_length_mm.standard_error = F_mm * sigma;
        if (free[k] == 1 && !both_free) out.f_number.standard_error = n * sigma;
        if (free[k] == 2) out.focus_distance_m.standard_error = sigma / (q * q);
    }
    return out;
}

}  // namespace postlens
