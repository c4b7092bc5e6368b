#include "compare/lens_from_picture.h"

#include <algorithm>
#include <ceres/ceres.h>
#include <cmath>
#include <map>

#include "compare/lens_search/picture_residuals.h"
#include "core/error.h"
#include "focus/focus.h"

namespace postlens {
namespace {

/// Limits of the Huber loss, for fitting a lens to a given image. Errors of a pixel (in logarithmic
/// brightness) below the limit count quadratically, and larger ones linearly. The first, rough fit uses
/// `first_linear_from`. The last fit uses `last_linear_from`, which is the noise of an image with 256 samples
/// per pixel.
constexpr double first_linear_from = 0.1, last_linear_from = 0.02;
/// Step of a numerical derivative, for fitting a lens to a given image. The derivative is that of the image
/// with respect to the inverse focus distance (1 / distance). The step is a fraction of the scene's range of
/// inverse depths.
constexpr double focus_step = 0.03;
/// The standard errors of the fitted lens are estimated from blocks of pixels of this width and height, in
/// px. Residuals of the fit may be correlated within a block, but are assumed to be independent between
/// blocks.
constexpr std::size_t block_px = 16;
/// Smallest contrast of a given image with which a lens is fitted. The contrast is the RMS difference between
/// the image's tones (logarithmic brightness) and their median. An image with less contrast is almost
/// uniform, so it does not show how much it is blurred.
constexpr double least_spread = 1e-3;
/// Largest accepted error of a fit, as a fraction of the given image's contrast. Both are RMS values of
/// logarithmic brightness. The fraction is usually about 0.1, but almost 1 if the given image shows the scene
/// from another viewpoint.
constexpr double most_left = 0.5;
/// A given image is rejected as unblurred if the best fitting lens reproduces it hardly better than a pinhole
/// does. The error of the best lens's image, divided by that of the sharp pinhole image, is then larger than
/// this value.
constexpr double least_gain = 0.8;
/// The fit is rejected if the scene's range of inverse depths is below this fraction of the largest inverse
/// depth. All objects then have practically the same depth.
constexpr double least_span = 0.01;
/// Largest accepted standard errors of a fitted lens. That of the aperture may be at most this fraction of
/// the aperture's diameter. That of the inverse focus distance may be at most this fraction of the scene's
/// range of inverse depths (1/nearest - 1/farthest). Otherwise, the lens is rejected.
constexpr double most_error = 0.2;
/// The fit may find several lenses that reproduce the given image almost equally well. A lens is reported in
/// addition to the best lens if its error is less than this factor times the error of the best lens.
constexpr double nearly_as_good = 1.25;

struct View {
    const SampleFileReader& file;
    RecordedDepths depths;
    double nearest_per_m = 0, span_per_m = 0;

    [[nodiscard]] FocusGeometry geometry(const LensPlace& p) const {
        const SampleHeader& h = file.header();
        return {.aperture_radius_m = p.aperture_mm / 2000,
                .inverse_focus_per_m = p.inverse_focus_per_m,
                .gain_px = h.film_distance_mm / h.pixel_pitch_mm};
    }
};

class Cost final : public ceres::CostFunction {
  public:
    Cost(PictureResiduals& residuals, double focus_step_per_m, double linear_from)
        : residuals_(residuals), focus_step_per_m_(focus_step_per_m), linear_from_(linear_from) {
        set_num_residuals(static_cast<int>(residuals.size()));
        mutable_parameter_block_sizes()->push_back(2);
    }
    /// Parameters of the lens: the logarithm of the aperture diameter (mm), and the inverse focus distance
    /// (1/m).
    bool Evaluate(const double* const* parameters, double* out, double** jacobians) const override {
        const LensPlace p{std::exp(parameters[0][0]), parameters[0][1]};
        residuals_.at(p, out, linear_from_);
        if (jacobians != nullptr && jacobians[0] != nullptr)
            residuals_.derivatives(p, focus_step_per_m_, linear_from_, jacobians[0]);
        return true;
    }

  private:
    PictureResiduals& residuals_;
    double focus_step_per_m_, linear_from_;
};

struct Descent {
    LensPlace place;
    bool converged = false;
};

Descent descend(PictureResiduals& residuals, const View& view, const LensPlace& from, double linear_from,
                double tolerance) {
    double at[2] = {std::log(from.aperture_mm), from.inverse_focus_per_m};
    ceres::Problem problem;
    problem.AddResidualBlock(new Cost(residuals, focus_step * view.span_per_m, linear_from), nullptr, at);
    problem.SetParameterLowerBound(at, 1, 0);
    problem.SetParameterUpperBound(at, 1, 3 * view.nearest_per_m);
    problem.SetParameterLowerBound(at, 0, at[0] - std::log(10.0));
    problem.SetParameterUpperBound(at, 0, at[0] + std::log(10.0));
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 10;
    // Stops the solver after a step that reduces the error by less than the fraction `tolerance`, for example
    // by less than 1e-4 of the error in the last, most accurate fit. A further step would then change the
    // lens by far less than 0.1 %.
    options.function_tolerance = tolerance;
    // Stops the solver when a nearly full step (trust region radius of at least 1e3) no longer lowers the
    // error. Smaller steps would not help, because the computed image changes only in discrete steps when the
    // lens changes.
    options.initial_trust_region_radius = 1e4;
    options.min_trust_region_radius = 1e3;
    options.parameter_tolerance = 2e-5;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return {{std::exp(at[0]), at[1]}, summary.termination_type == ceres::CONVERGENCE};
}

void check(const SampleFileReader& file, const Image& picture, const LensFromPictureSettings& s) {
    const SampleHeader& h = file.header();
    if (s.starts < 1 || s.starts > 16)
        fail(ExitCode::wrong_arguments, "starts: out of range (got {}; expected 1 to 16)", s.starts);
    if (h.projection == Projection::orthographic) {
        fail(
            ExitCode::wrong_arguments,
            "no lens took a picture of parallel rays (got an orthographic file; expected a perspective one)");
    }
    if (picture.width != h.width || picture.height != h.height) {
        fail(ExitCode::invalid_input,
             "the picture is not of the sample file's view (got {}x{} px; expected {}x{} px)", picture.width,
             picture.height, h.width, h.height);
    }
    const auto bad =
        std::count_if(picture.rgb.begin(), picture.rgb.end(), [](float v) { return !std::isfinite(v); });
    if (bad > 0) {
        fail(ExitCode::invalid_input, "the picture has values that are not finite (got {}; expected none)",
             bad);
    }
}

void refuse_no_blur(double lens_error, double pinhole_error) {
    fail(ExitCode::invalid_input,
         "the picture shows no blur from which a lens could be told (got an error of {:.3g} with the best "
         "lens, "
         "{:.3g} without any; expected a clear gain)",
         lens_error, pinhole_error);
}

void refuse_other_view(double error, double spread) {
    fail(ExitCode::invalid_input,
         "no lens makes this picture from these records: another view, another exposure, or motion (got "
         "{:.0f} % of the picture's variation unexplained; expected at most {:.0f} %)",
         100 * error / spread, 100 * most_left);
}

void refuse_one_depth() {
    fail(ExitCode::invalid_input,
         "the picture does not tell aperture and focus apart (got blur at one depth, or too little; expected "
         "it "
         "at two or more)");
}

/// Computes the standard errors of the aperture and of the focus distance of the fitted lens, `out.best`.
/// Throws if one of them exceeds the limit `most_error`.
void add_errors(PictureResiduals& residuals, const View& view, LensFromPicture& out) {
    std::vector<double> r(residuals.size()), jacobian(2 * residuals.size());
    residuals.at(out.best.place, r.data(), last_linear_from);
    residuals.derivatives(out.best.place, focus_step * view.span_per_m, last_linear_from, jacobian.data());
    struct Sums {
        double a = 0, b = 0;
    };
    const auto width = static_cast<std::size_t>(view.depths.width);
    std::map<std::size_t, Sums> blocks;
    double aa = 0, ab = 0, bb = 0;
    for (std::size_t k = 0; k < r.size(); ++k) {
        const double a = jacobian[2 * k], b = jacobian[2 * k + 1];
        aa += a * a;
        ab += a * b;
        bb += b * b;
        const std::size_t pixel = residuals.pixel(k);
        Sums& sums = blocks[pixel / width / block_px * width + pixel % width / block_px];
        sums.a += a * r[k];
        sums.b += b * r[k];
    }
    const double determinant = aa * bb - ab * ab;
    double var_a = 0, var_b = 0, cov = 0;
    for (const auto& [block, s] : blocks) {
        const double a = (bb * s.a - ab * s.b) / determinant, b = (aa * s.b - ab * s.a) / determinant;
        var_a += a * a;
        var_b += b * b;
        cov += a * b;
    }
    const double error_a = std::sqrt(var_a), error_b = std::sqrt(var_b);
    // Rejects the fit if the image does not determine the lens. If the determinant of the fit's normal matrix
    // is small, a change of the aperture and a change of the focus distance have the same effect on the
    // image. So the two cannot be determined separately.
    if (!(determinant > 1e-4 * aa * bb) || !(error_a < most_error) ||
        !(error_b < most_error * view.span_per_m)) {
        refuse_one_depth();
    }
    out.aperture_error_mm = out.best.place.aperture_mm * error_a;
    out.inverse_focus_error_per_m = error_b;
    out.correlation = var_a > 0 && var_b > 0 ? cov / (error_a * error_b) : -ab / std::sqrt(aa * bb);
}

/// Fits a lens to the given image in two descents (minimisations of the image error), beginning with the lens
/// `from`. Each descent compares only pixels whose blur is reliable, i.e. does not cross a depth edge or the
/// border of the recorded pixels. These depend on the lens, so they are selected again before the second
/// descent.
Descent refine(PictureResiduals& residuals, const View& view, const LensPlace& from) {
    residuals.use(reliable_pixels(view.depths, view.geometry(from)));
    const Descent rough = descend(residuals, view, from, first_linear_from, 1e-2);
    residuals.use(reliable_pixels(view.depths, view.geometry(rough.place)));
    return descend(residuals, view, rough.place, last_linear_from, 1e-4);
}

/// Returns true if the lenses `a` and `b` are so similar that they count as one. Such pairs occur because the
/// coarse search, which finds the starting points of the fit, may find several lenses near the same minimum
/// of the image error.
bool alike(const LensPlace& a, const LensPlace& b, double span_per_m) {
    return std::abs(std::log(a.aperture_mm / b.aperture_mm)) < 0.3 &&
           std::abs(a.inverse_focus_per_m - b.inverse_focus_per_m) < 0.1 * span_per_m;
}

/// Selects at most `most` lenses as starting points for the fit. `matches` are the lenses that a rough search
/// found, sorted by their rough errors. If two of them are similar, only the one with the smaller error is
/// used.
std::vector<RoughMatch> sifted(PictureResiduals& residuals, const View& view,
                               const std::vector<RoughMatch>& matches, int most) {
    std::vector<RoughMatch> out;
    for (const RoughMatch& m : matches) {
        const bool known = std::any_of(out.begin(), out.end(), [&](const RoughMatch& better) {
            return alike(better.place, m.place, view.span_per_m);
        });
        if (!known) out.push_back(m);
        if (out.size() == static_cast<std::size_t>(most)) break;
    }
    // For each selected lens, an accurate image is made. Lenses whose image has more than 1.5 times the
    // smallest error are omitted.
    for (RoughMatch& s : out) s.error = residuals.rms_at(s.place, first_linear_from);
    std::stable_sort(out.begin(), out.end(),
                     [](const RoughMatch& a, const RoughMatch& b) { return a.error < b.error; });
    const double limit = 1.5 * out.front().error;
    std::erase_if(out, [&](const RoughMatch& s) { return s.error > limit; });
    return out;
}

}  // namespace

LensFromPicture lens_from_picture(const SampleFileReader& file, const Image& picture,
                                  const LensFromPictureSettings& settings) {
    check(file, picture, settings);
    View view{file, recorded_depths(file)};
    view.nearest_per_m = view.depths.nearest();
    if (view.nearest_per_m == 0) {
        fail(ExitCode::invalid_input,
             "the sample file shows nothing at a finite depth (expected something that a lens can blur)");
    }
    view.span_per_m = view.nearest_per_m - view.depths.farthest();

    PictureResiduals residuals(file, picture, settings.impulse,
                               static_cast<std::uint64_t>(25 * settings.starts));
    if (view.span_per_m < least_span * view.nearest_per_m) refuse_one_depth();
    const Image pinhole = pinhole_picture(file);
    const double spread = residuals.rms_of_even(first_linear_from);
    if (spread < least_spread) {
        fail(ExitCode::invalid_input,
             "the picture is the same all over (got a variation of {:.2g}; expected {:g} or more)", spread,
             least_spread);
    }
    const double sharp_error = residuals.rms_of(pinhole, first_linear_from);
    if (sharp_error < least_spread) refuse_no_blur(sharp_error, sharp_error);
    const std::vector<RoughMatch> starts =
        sifted(residuals, view, blur_search(pinhole, picture, view.depths, file.header()), settings.starts);
    if (starts.front().error > least_gain * spread) refuse_other_view(starts.front().error, spread);

    // Rejects a given image without lens blur. Such an image is matched best by a sharp pinhole image, whose
    // error is `sharp_error`. If the given image had lens blur, the best of the roughly fitted lenses,
    // `starts.front()`, would have a smaller error.
    if (starts.front().error > sharp_error) refuse_no_blur(starts.front().error, sharp_error);

    std::vector<LensFromPicture> found;
    for (const RoughMatch& start : starts) {
        const Descent end = refine(residuals, view, start.place);
        if (!end.converged) continue;
        LensFromPicture one;
        one.best = {end.place, residuals.rms_at(end.place, last_linear_from)};
        one.pinhole_error = residuals.rms_of(pinhole, last_linear_from);
        one.spread = residuals.rms_of_even(last_linear_from);
        one.reliable_share =
            static_cast<double>(residuals.size()) / static_cast<double>(view.depths.nearest_per_m.size());
        const bool known = std::any_of(found.begin(), found.end(), [&](const LensFromPicture& f) {
            return alike(f.best.place, end.place, view.span_per_m);
        });
        if (!known) found.push_back(one);
    }
    if (found.empty()) {
        fail(ExitCode::invalid_input,
             "the search for a lens came to no end (got none of {} starts to converge; expected one)",
             starts.size());
    }
    // Sorts the fitted lenses by their relative errors `error` / `spread`. Here `spread` is the contrast of
    // the given image in the pixels in which the lens was compared with it. These pixels are different for
    // each lens, so only the relative errors are comparable.
    std::stable_sort(found.begin(), found.end(), [](const LensFromPicture& a, const LensFromPicture& b) {
        return a.best.error * b.spread < b.best.error * a.spread;
    });
    LensFromPicture out = found.front();
    if (out.best.error > most_left * out.spread) refuse_other_view(out.best.error, out.spread);
    if (out.best.error > least_gain * out.pinhole_error) refuse_no_blur(out.best.error, out.pinhole_error);
    for (std::size_t i = 1; i < found.size(); ++i) {
        if (found[i].best.error * out.spread < nearly_as_good * out.best.error * found[i].spread)
            out.others.push_back(found[i].best);
    }
    const FocusGeometry geometry = view.geometry(out.best.place);
    out.largest_coc_px = view.depths.largest_coc_px(geometry);
    residuals.use(reliable_pixels(view.depths, geometry));
    add_errors(residuals, view, out);
    out.pictures = residuals.pictures();
    return out;
}

}  // namespace postlens
