#include <algorithm>
#include <ceres/ceres.h>
#include <cmath>

#include "core/error.h"
#include "lens/traced/lens_models.h"

namespace postlens {
namespace {

using glm::dvec2;

constexpr int nodes = 25;
constexpr int edge_nodes = 65;
constexpr int circle_numbers = 6;

// Error, in mm, of the polynomial lens model's prediction of x or y where a ray lands on the film. It is
// linear in the model's coefficients.
class LandingResidual : public ceres::SizedCostFunction<1, static_cast<int>(polynomial_terms)> {
  public:
    LandingResidual(const std::array<double, polynomial_terms>& terms, double mm) : terms_(terms), mm_(mm) {}
    bool Evaluate(double const* const* parameters,
                  double* residuals,  // NOLINT(readability-identifier-naming)
                  double** jacobians) const override {
        double sum = -mm_;
        for (std::size_t i = 0; i < polynomial_terms; ++i) sum += parameters[0][i] * terms_[i];
        residuals[0] = sum;
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            std::copy(terms_.begin(), terms_.end(), jacobians[0]);
        }
        return true;
    }

  private:
    std::array<double, polynomial_terms> terms_;
    double mm_;
};

// Residual of the fit of the modelled pupil to the traced pupil. It is the signed distance of `at`, a point
// on the edge of the traced pupil, from the edge of the modelled pupil. The distance is in pupil radii, and
// positive outside.
struct EdgeResidual {
    dvec2 at;
    double T = 0, K = 0;
    template <typename Number>
    bool operator()(const Number* circles, Number* residual) const {
        using std::sqrt;
        // The modelled pupil is the intersection of three circles, so the residual is the largest of the
        // signed distances from these circles.
        bool first = true;
        for (int i = 0; i < 3; ++i) {
            const Number* c = circles + circle_numbers * i;
            const Number y = at.y - (c[0] + c[4] * K) * T - c[1] * (T * T * T);
            // At 0, the derivative of the square root would be infinite. Adding 1e-12 avoids this.
            const Number outside = sqrt(at.x * at.x + y * y + 1e-12) - (c[2] + c[3] * (T * T) + c[5] * K);
            if (first || outside > residual[0]) residual[0] = outside;
            first = false;
        }
        return true;
    }
};

ceres::Solver::Options options() {
    ceres::Solver::Options out;
    out.linear_solver_type = ceres::DENSE_QR;
    out.max_num_iterations = 100;
    out.num_threads = 1;  // threads would change the order of summation
    out.logging_type = ceres::SILENT;
    return out;
}

void solve(ceres::Problem& problem, const char* what) {
    ceres::Solver::Summary summary;
    ceres::Solve(options(), &problem, &summary);
    if (!summary.IsSolutionUsable()) {
        fail(ExitCode::invalid_input, "the {} of this lens cannot be fitted (Ceres: {})", what,
             summary.message);
    }
}

// Adds residuals that fit the modelled pupil to the traced pupil. If one of two neighbouring rays in `mesh`
// passes the lens and the other does not, the residual is the distance of the modelled edge from the midpoint
// between the two rays.
// - T, K: tangent of the object point's angle from the axis, and its defocus, each divided by its largest
//   value
// - radius_mm: pupil radius, the unit of the circles
void add_edge(const PupilMesh& mesh, double T, double K, double radius_mm, ceres::Problem& problem,
              double* circles) {
    const auto n = static_cast<std::size_t>(mesh.nodes);
    const auto add = [&](std::size_t a, std::size_t b) {
        if (mesh.passes[a] == mesh.passes[b]) return;
        const dvec2 at = 0.5 * (mesh.pupil_mm[a] + mesh.pupil_mm[b]) / radius_mm;
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<EdgeResidual, 1, 3 * circle_numbers>(new EdgeResidual{at, T, K}),
            nullptr, circles);
    };
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t k = j * n + i;
            if (i + 1 < n) add(k, k + 1);
            if (j + 1 < n) add(k, k + n);
        }
    }
}

// Returns initial values for fitting the pupil model, which is the intersection of three circles. The circles
// are the paraxial images, seen from the scene, of three openings: the stop, the rim of the first surface,
// and the rim of the last surface.
std::array<PupilCircle, 3> paraxial_circles(const Prescription& lens, const TracedLens& traced,
                                            double radius_mm, double largest_tangent) {
    const FirstOrder& f = traced.first_order();
    const LensStack& stack = traced.stack();
    constexpr double wide = 10;
    std::array<PupilCircle, 3> out;
    out[1].radius = out[2].radius = wide;
    const auto rim = [&](std::size_t surface, PupilCircle& circle) {
        const double clear = stack.clear_radius_mm(surface);
        if (!std::isfinite(clear) || surface == stack.stop()) return;
        // Projects the rim of this lens surface to the entrance pupil, where it becomes one of the pupil
        // model's three circles. A paraxial ray through the pupil at the height q meets the surface at the
        // height a q - b t, where t is the tangent of the ray's angle from the axis.
        const double z = f.entrance_pupil_z_mm;
        // Two rays are traced to find a and b: one with q = 1 and t = 0, and one with q = 0 and t = -1.
        const double a = paraxial_ray(lens, traced.wavelength_nm(), {1, 0}, surface).y_mm;
        const double b = paraxial_ray(lens, traced.wavelength_nm(), {-z, 1}, surface).y_mm;
        if (std::abs(a) < 1e-6) return;
        circle.shift = b / a * largest_tangent / radius_mm;
        circle.radius = std::min(clear / std::abs(a) / radius_mm, wide);
    };
    rim(0, out[1]);
    rim(stack.size() - 1, out[2]);
    return out;
}

}  // namespace

PolynomialLens fit_polynomial_lens(const Prescription& lens, const TracedLens& traced,
                                   const LensModelRange& range) {
    PolynomialLens out;
    const FirstOrder& f = traced.first_order();
    out.pupil_radius_mm = 0.5 * f.entrance_pupil_diameter_mm * f.f_number / traced.f_number();
    out.largest_tangent = std::max(*std::max_element(range.tangents.begin(), range.tangents.end()), 1e-9);
    const auto focus = traced.settings().focus_distance_m;
    out.inverse_focus_per_m = focus ? 1 / *focus : 0;
    out.largest_defocus_per_m = 1e-9;
    for (const double depth : range.depths_m) {
        out.largest_defocus_per_m =
            std::max(out.largest_defocus_per_m, std::abs(1 / depth - out.inverse_focus_per_m));
    }
    out.circles = paraxial_circles(lens, traced, out.pupil_radius_mm, out.largest_tangent);
    std::array<double, std::size_t{3} * circle_numbers> circles{};
    for (std::size_t i = 0; i < 3; ++i) {
        const PupilCircle& c = out.circles[i];
        const double values[circle_numbers] = {c.shift, c.bend, c.radius, c.growth, 0, 0};
        std::copy(std::begin(values), std::end(values), &circles[circle_numbers * i]);
    }
    ceres::Problem landing_x, landing_y, edge;
    PupilMesh mesh;
    std::size_t passing = 0;
    for (const double tangent : range.tangents) {
        const double T = tangent / out.largest_tangent;
        for (const double depth : range.depths_m) {
            const double K = (1 / depth - out.inverse_focus_per_m) / out.largest_defocus_per_m;
            if (!traced.impulse(depth, {0, tangent}, nodes, mesh)) continue;
            for (std::size_t k = 0; k < mesh.passes.size(); ++k) {
                if (mesh.passes[k] == 0) continue;
                ++passing;
                const dvec2 p = mesh.pupil_mm[k] / out.pupil_radius_mm;
                std::array<double, polynomial_terms> x{}, y{};
                PolynomialLens::terms(p.x, p.y, T, K, x, y);
                landing_x.AddResidualBlock(new LandingResidual(x, mesh.film_mm[k].x), nullptr,
                                           out.x_mm.data());
                landing_y.AddResidualBlock(new LandingResidual(y, mesh.film_mm[k].y), nullptr,
                                           out.y_mm.data());
            }
            if (traced.impulse(depth, {0, tangent}, edge_nodes, mesh)) {
                add_edge(mesh, T, K, out.pupil_radius_mm, edge, circles.data());
            }
        }
    }
    if (passing < 4 * polynomial_terms) {
        fail(ExitCode::invalid_input,
             "too few rays get through the lens for a fit (got {}; expected at least {})", passing,
             4 * polynomial_terms);
    }
    solve(landing_x, "landing points");
    solve(landing_y, "landing points");
    solve(edge, "pupil");
    for (std::size_t i = 0; i < 3; ++i) {
        const double* c = &circles[circle_numbers * i];
        out.circles[i] = {c[0], c[1], c[2], c[3], c[4], c[5]};
    }
    return out;
}

}  // namespace postlens
