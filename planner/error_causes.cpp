#include "planner/error_causes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "focus/bend_warning.h"
#include "focus/field_focus.h"
#include "planner/local_contrast.h"
#include "planner/record_floor.h"
#include "records/aperture_file.h"
#include "records/srgb.h"

namespace postlens {
namespace {

constexpr int views = 256;
/// An error that is at most half as large without it is there because of it.
constexpr double explained = 0.25;
/// Expected errors are good to an order of magnitude; that of the records' density is what cells that see an
/// edge tell, and those beside them may hide any number.
constexpr double noticeable = 0.1, noticeable_density = 0.02;
constexpr int beside_px = 4;

double squared_difference(const Image& a, const Image& b, std::size_t pixel) {
    double sum = 0;
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
        const double d =
            static_cast<double>(srgb_from_linear(a.rgb[c])) - static_cast<double>(srgb_from_linear(b.rgb[c]));
        sum += d * d / 3;
    }
    return sum;
}

bool is_wrong(const Image& a, const Image& b, std::size_t pixel, double above) {
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
        const double d =
            static_cast<double>(srgb_from_linear(a.rgb[c])) - static_cast<double>(srgb_from_linear(b.rgb[c]));
        if (!(std::abs(d) <= above)) return true;
    }
    return false;
}

/// By pixel of the picture, the share of its light that may come from beyond the recorded margin: the part of
/// the widest circle of confusion near it that lies outside.
std::vector<float> beyond_margin(FocusFrame& frame, const FocusGeometry& geometry) {
    const SampleHeader& h = frame.file().header();
    std::vector<float> out(static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height), 0.0F);
    // The widest circle along each of the recorded sides decides what may come in over it.
    double left = 0, right = 0, top = 0, bottom = 0;
    const int margin = h.overscan_px;
    constexpr int side = 8;
    frame.visit_rows(frame.file().y_begin(), frame.file().y_end(), [&](const FrameRows& rows) {
        for (const Record& r : rows.band->records) {
            if (r.layer != 0 || r.path.bits() != 0) continue;
            const double inverse_z = std::isfinite(r.z) && r.z > 0 ? 1 / static_cast<double>(r.z) : 0;
            const double radius = std::abs(geometry.coc_diameter_px(inverse_z)) / 2;
            const auto x = static_cast<double>(r.x), y = static_cast<double>(r.y);
            if (x < side - margin) left = std::max(left, radius);
            if (x > h.width + margin - side) right = std::max(right, radius);
            if (y < side - margin) top = std::max(top, radius);
            if (y > h.height + margin - side) bottom = std::max(bottom, radius);
        }
    });
    const auto outside = [](double distance_px, double radius_px) {
        if (radius_px <= distance_px) return 0.0;
        // Of a disc, the part beyond a straight line.
        const double t = std::clamp(distance_px / radius_px, 0.0, 1.0);
        return 0.5 - (t * std::sqrt(1 - t * t) + std::asin(t)) / M_PI;
    };
    for (int y = 0; y < h.height; ++y) {
        for (int x = 0; x < h.width; ++x) {
            const double share = outside(x + 0.5 + margin, left) +
                                 outside(h.width - x - 0.5 + margin, right) + outside(y + 0.5 + margin, top) +
                                 outside(h.height - y - 0.5 + margin, bottom);
            out[static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width) +
                static_cast<std::size_t>(x)] = static_cast<float>(std::min(1.0, share));
        }
    }
    return out;
}

/// Means over the pixels within `radius_px` to each side.
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

/// What it means that the light field is right where a picture is wrong.
ErrorCause explained_by_views(const CauseRequest& request, bool moves) {
    if (request.method == FocusMethod::lightfield || request.method == FocusMethod::hybrid)
        return ErrorCause::record_density;  // its own views were too few
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
    const FocusGeometry geometry = focus_geometry(v.focus.lens, v.focus.focus_distance_m, Framing::keep,
                                                  {h.film_distance_mm, h.pixel_pitch_mm});
    const bool moves = v.motion != nullptr && v.shutter && v.shutter->open_s < v.shutter->close_s;

    // The light field of the records knows of order and, with a shutter, of instants.
    FieldFocusSettings by_field{
        geometry, read_aperture(v.focus.impulse), {0, h.width, 0, h.height}, views, {}, {}};
    if (moves) by_field.shutter = {v.motion, v.shutter->open_s, v.shutter->close_s, v.curve};
    MisplacedLight misplaced_light(h, geometry);
    by_field.also = [&](const RecordBand& band, int y_begin, int y_end) {
        misplaced_light.add(band, y_begin, y_end);
    };
    const FieldFocus seen = field_focus(frame, by_field);
    std::optional<Image> finer;
    if (request.method == FocusMethod::scatter && request.depths) {
        FocusSettings s = v.focus;
        s.method = FocusMethod::scatter;
        s.spacing = DepthSpacing::inverse;
        s.depths = std::min(4 * *request.depths, DepthLevels::most_depths);
        finer = focus_picture(frame, s).image;
    }
    const std::vector<float> floor = record_floor(frame.file(), geometry),
                             misplaced = misplaced_light.picture(), margin = beyond_margin(frame, geometry),
                             contrast = local_contrast(seen.image);

    const std::vector<float> beside = box_means(floor, h.width, h.height, beside_px);
    const double overall =
        std::accumulate(contrast.begin(), contrast.end(), 0.0) / static_cast<double>(contrast.size());

    CauseMap out;
    out.width = h.width;
    out.height = h.height;
    out.causes.assign(floor.size(), ErrorCause::none);
    double all = 0;
    for (std::size_t k = 0; k < floor.size(); ++k) {
        if (!is_wrong(image, reference, k, request.wrong_above)) continue;
        const double error = squared_difference(image, reference, k);
        ErrorCause cause = ErrorCause::view_dependent_shading;
        if (finer && squared_difference(*finer, reference, k) <= explained * error) {
            cause = ErrorCause::kernel_truncation;
        } else if (squared_difference(seen.image, reference, k) <= explained * error) {
            cause = explained_by_views(request, moves);
        } else {
            // What is not recorded may differ from what is beside it as much as anything in the picture does.
            const double spread = std::max(static_cast<double>(contrast[k]), overall),
                         beyond = static_cast<double>(margin[k]);
            // What lies beyond the margin is unknown to the views as well.
            const double unknown =
                std::max(0.0, static_cast<double>(std::max(seen.unknown[k], seen.unknown_below[k])) - beyond);
            const double lost = misplaced.empty() ? 0 : static_cast<double>(srgb_from_linear(misplaced[k]));
            const std::array<std::pair<double, ErrorCause>, 4> expected{
                {{unknown * unknown * spread, ErrorCause::hidden_surface},
                 {lost * lost / 4, ErrorCause::curvature_of_w},
                 {beyond * beyond * spread, ErrorCause::frame_edge},
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
