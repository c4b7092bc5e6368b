#include "planner/error_causes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "focus/bend_warning.h"
#include "focus/light_field/field_focus.h"
#include "pictures/srgb.h"
#include "planner/errors/error_trials.h"
#include "planner/errors/local_contrast.h"
#include "planner/errors/record_floor.h"
#include "planner/views/picture_request.h"

namespace postlens {
namespace {

constexpr int many_views = 256;
/// A pixel is wrong if the sRGB value of some channel differs from the reference image by more than this.
constexpr double wrong_above = 1.0 / 255;
/// A possible cause of a pixel's error is confirmed if an image in which this cause is removed has at most
/// this fraction of the pixel's squared error. With a quarter, the error itself is at most half as large.
constexpr double explained = 0.25;
/// A cause of a pixel's error is accepted if its estimate is at least the fraction `noticeable` of the
/// pixel's measured squared error. For too sparse samples as the cause, the smaller fraction
/// `noticeable_density` suffices.
constexpr double noticeable = 0.1, noticeable_density = 0.02;
constexpr int beside_px = 4;
/// A pixel counts as completely recorded if the sample file lacks less than this fraction of its light.
constexpr float tolerated_unknown = 0.02F;
/// The scene is traced again, to find more causes of wrong pixels, only if the pixels without a known cause
/// contribute more than this fraction of the image's squared error. For a smaller fraction, this would be too
/// expensive.
constexpr double worth_trials = 0.1;

double squared_difference(const Image& a, const Image& b, std::size_t pixel) {
    double sum = 0;
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
        const double d =
            static_cast<double>(srgb_from_linear(a.rgb[c])) - static_cast<double>(srgb_from_linear(b.rgb[c]));
        sum += d * d / 3;
    }
    return sum;
}

bool is_wrong(const Image& a, const Image& b, std::size_t pixel) {
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
        const double d =
            static_cast<double>(srgb_from_linear(a.rgb[c])) - static_cast<double>(srgb_from_linear(b.rgb[c]));
        if (!(std::abs(d) <= wrong_above)) return true;
    }
    return false;
}

/// Estimates which fraction of a pixel's light comes from outside the traced image: the part of its circle of
/// confusion that lies beyond the overscan (pixels traced around the image).
class BeyondMargin {
  public:
    BeyondMargin(const SampleHeader& header, const FocusGeometry& geometry)
        : h_(header), geometry_(geometry) {}

    /// Adds the samples of `band`. Samples may be added twice.
    void add(const RecordBand& band) {
        constexpr int side = 8;
        const int margin = h_.overscan_px;
        for (const Record& r : band.records) {
            if (r.layer != 0 || r.path.bits() != 0) continue;
            const double inverse_z = std::isfinite(r.z) && r.z > 0 ? 1 / static_cast<double>(r.z) : 0;
            const double radius = std::abs(geometry_.coc_diameter_px(inverse_z)) / 2;
            const auto x = static_cast<double>(r.x), y = static_cast<double>(r.y);
            if (x < side - margin) left_ = std::max(left_, radius);
            if (x > h_.width + margin - side) right_ = std::max(right_, radius);
            if (y < side - margin) top_ = std::max(top_, radius);
            if (y > h_.height + margin - side) bottom_ = std::max(bottom_, radius);
        }
    }

    [[nodiscard]] double share(int x, int y) const {
        const int margin = h_.overscan_px;
        return std::min(1.0, outside(x + 0.5 + margin, left_) + outside(h_.width - x - 0.5 + margin, right_) +
                                 outside(y + 0.5 + margin, top_) +
                                 outside(h_.height - y - 0.5 + margin, bottom_));
    }

  private:
    /// Returns the fraction of a disc's area that lies beyond a straight line at `distance_px` from the
    /// disc's centre.
    static double outside(double distance_px, double radius_px) {
        if (radius_px <= distance_px) return 0;
        const double t = std::clamp(distance_px / radius_px, 0.0, 1.0);
        return 0.5 - (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
    }

    const SampleHeader& h_;
    FocusGeometry geometry_;
    double left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  ///< largest CoC radius along each side, px
};

std::vector<float> box_means(const std::vector<float>& of, int width, int height, int radius_px) {
    std::vector<float> rows(of.size()), out(of.size());
    const auto at = [](int line, int next, int i, int step) {
        return static_cast<std::size_t>(line) * static_cast<std::size_t>(next) +
               static_cast<std::size_t>(i) * static_cast<std::size_t>(step);
    };
    const auto pass = [&](const std::vector<float>& from, std::vector<float>& to, int count, int length,
                          int step, int next) {
        for (int line = 0; line < count; ++line) {
            for (int i = 0; i < length; ++i) {
                double sum = 0;
                const int first = std::max(0, i - radius_px), last = std::min(length - 1, i + radius_px);
                for (int k = first; k <= last; ++k) sum += static_cast<double>(from[at(line, next, k, step)]);
                to[at(line, next, i, step)] = static_cast<float>(sum / (last - first + 1));
            }
        }
    };
    pass(of, rows, height, width, 1, width);
    pass(rows, out, width, height, width, 1);
    return out;
}

/// Returns the cause of a pixel's error if the mean of many views (images from different lens points) does
/// not have this error. The views are made from the same sample file, so the cause lies in the method with
/// which the image was made.
ErrorCause explained_by_views(const CauseRequest& request, bool moves) {
    if (request.method == FocusMethod::lightfield || request.method == FocusMethod::hybrid)
        return ErrorCause::record_density;  // the image had too few views
    if (request.view.focus.depth_model != DepthModel::ray_differentials) return ErrorCause::curvature_of_w;
    return moves ? ErrorCause::path_and_depth_correlated : ErrorCause::visibility;
}

}  // namespace

std::string_view cause_name(ErrorCause cause) {
    constexpr std::array<std::string_view, error_causes> names{
        "none",           "hidden-surface",         "visibility",
        "curvature-of-W", "view-dependent-shading", "path-and-depth-correlated",
        "frame-edge",     "kernel-truncation",      "record-density"};
    return names[static_cast<std::size_t>(cause)];
}

CauseMap find_error_causes(FocusFrame& frame, const Image& image, const Image& reference,
                           const CauseRequest& request) {
    const SampleHeader& h = frame.file().header();
    for (const Image* i : {&image, &reference}) {
        if (i->width != h.width || i->height != h.height) {
            fail(ExitCode::invalid_input,
                 "the sample file has another size than the pictures (got {}x{}; expected {}x{})", h.width,
                 h.height, i->width, i->height);
        }
    }
    const HybridSettings& v = request.view;
    const bool moves = v.motion != nullptr && v.shutter && v.shutter->open_s < v.shutter->close_s;

    // `seen` is the mean of many views (images for one lens point and instant), which renders occlusion and
    // motion correctly. It is made from the same sample file as `image`. So if a pixel's error is much
    // smaller in `seen`, the method of `image` is its cause.
    FieldFocusSettings by_field = field_settings(h, v);
    by_field.views = many_views;
    by_field.crop.reset();
    if (!moves) by_field.shutter.reset();
    const FocusGeometry& geometry = by_field.geometry;
    MisplacedLight misplaced_light(h, geometry);
    RecordFloor record_floor(h, geometry);
    BeyondMargin margin(h, geometry);
    by_field.also.rows = [&](const RecordBand& band, int y_begin, int y_end) {
        misplaced_light.add(band, y_begin, y_end);
        margin.add(band);
    };
    by_field.also.leaves = record_floor.adds();
    const FieldFocus seen = field_focus(frame, by_field);
    by_field.also = {};
    std::optional<Image> finer;
    if (request.method == FocusMethod::scatter && request.depths) {
        FocusSettings s = v.focus;
        s.method = FocusMethod::scatter;
        s.spacing = DepthSpacing::inverse;
        s.depths = std::min(4 * *request.depths, DepthLevels::most_depths);
        finer = focus_picture(frame, s).image;
    }
    const std::vector<float>& floor = record_floor.picture();
    const std::vector<float> misplaced = misplaced_light.picture(), contrast = local_contrast(seen.image);
    const std::vector<float> beside = box_means(floor, h.width, h.height, beside_px);
    const double overall =
        std::accumulate(contrast.begin(), contrast.end(), 0.0) / static_cast<double>(contrast.size());

    const auto views_explain = [&](std::size_t k, double error) {
        return squared_difference(seen.image, reference, k) <= explained * error;
    };
    const auto finer_explains = [&](std::size_t k, double error) {
        return finer && squared_difference(*finer, reference, k) <= explained * error;
    };
    // An error trial traces the scene again with better settings, which is expensive. So trials are made only
    // if `seen` and `finer`, which are made from the existing sample file by better methods, still have much
    // of the error of `image`.
    std::vector<ErrorTrial> trials;
    if (v.scene != nullptr) {
        double all = 0, left = 0;
        for (std::size_t k = 0; k < floor.size(); ++k) {
            if (!is_wrong(image, reference, k)) continue;
            const double error = squared_difference(image, reference, k);
            all += error;
            left += finer_explains(k, error) || views_explain(k, error) ? 0 : error;
        }
        if (left > worth_trials * all) trials = error_trials(h, *v.scene, v, by_field);
    }

    CauseMap out;
    out.width = h.width;
    out.height = h.height;
    out.causes.assign(floor.size(), ErrorCause::none);
    double all = 0;
    for (std::size_t k = 0; k < floor.size(); ++k) {
        if (!is_wrong(image, reference, k)) continue;
        const double error = squared_difference(image, reference, k);
        ErrorCause cause = ErrorCause::view_dependent_shading;
        const ErrorTrial* best = nullptr;
        double best_error = explained * error;
        for (const ErrorTrial& t : trials) {
            const double e = squared_difference(t.image, reference, k);
            if (e > best_error) continue;
            best = &t;
            best_error = e;
            if (t.decides) break;
        }
        if (finer_explains(k, error)) {
            cause = ErrorCause::kernel_truncation;
        } else if (views_explain(k, error)) {
            cause = explained_by_views(request, moves);
        } else if (best != nullptr) {
            cause = best->cause;
            // `best` is an image from a new trace that removes this pixel's error. If the trace recorded
            // other instants than the file, but only a small fraction of the pixel's light is missing in the
            // file (`seen.unknown`), the cause is that colours change with time.
            if (best->other_instants && seen.unknown[k] < tolerated_unknown)
                cause = ErrorCause::view_dependent_shading;
        } else {
            const double spread = std::max(static_cast<double>(contrast[k]), overall),
                         beyond = margin.share(static_cast<int>(k % static_cast<std::size_t>(h.width)),
                                               static_cast<int>(k / static_cast<std::size_t>(h.width)));
            const double unknown =
                std::max(0.0, static_cast<double>(std::max(seen.unknown[k], seen.unknown_below[k])) - beyond);
            const double lost = misplaced.empty() ? 0 : static_cast<double>(srgb_from_linear(misplaced[k]));
            const std::array<std::pair<double, ErrorCause>, 4> expected{
                {{filled_in_error(unknown, spread), ErrorCause::hidden_surface},
                 {misplaced_error(lost), ErrorCause::curvature_of_w},
                 {filled_in_error(beyond, spread), ErrorCause::frame_edge},
                 {floor_unseen * static_cast<double>(floor[k]), ErrorCause::record_density}}};
            const auto greatest = *std::max_element(expected.begin(), expected.end());
            if (greatest.first >= noticeable * error) {
                cause = greatest.second;
            } else if (static_cast<double>(beside[k]) >= noticeable_density * error) {
                cause = ErrorCause::record_density;
            }
        }
        out.causes[k] = cause;
        out.error_share[static_cast<std::size_t>(cause)] += error;
        all += error;
    }
    if (all > 0) {
        for (double& share : out.error_share) share /= all;
    }
    return out;
}

}  // namespace postlens
