#include "planner/hybrid.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "focus/bend_warning.h"
#include "focus/depth_levels.h"
#include "focus/field_focus.h"
#include "planner/hidden_error.h"
#include "planner/retrace.h"
#include "records/aperture_file.h"
#include "records/crop.h"

namespace postlens {
namespace {

/// Pixels that records do not suffice for, the worst first, ties by place: of whose light too much is
/// unknown, or misplaced.
std::vector<std::uint32_t> insufficient(const FieldFocus& field, const std::vector<float>& misplaced,
                                        double tolerated, const std::optional<Crop>& crop) {
    std::vector<std::uint32_t> out;
    const auto error = [&](std::uint32_t k) {
        return std::max({field.unknown[k], field.unknown_below[k], misplaced.empty() ? 0.0F : misplaced[k]});
    };
    const auto width = static_cast<std::uint32_t>(field.image.width);
    for (std::uint32_t k = 0; k < field.unknown.size(); ++k) {
        if (crop && !crop->contains(static_cast<int>(k % width), static_cast<int>(k / width))) continue;
        if (static_cast<double>(error(k)) > tolerated) out.push_back(k);
    }
    std::stable_sort(out.begin(), out.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return error(a) > error(b); });
    return out;
}

/// Leaves out those where so many rays, most of which miss a highlight that the lens spreads, are expected to
/// be further off than the views.
void leave_to_views(std::vector<std::uint32_t>& pixels, const FieldFocus& field,
                    const MisplacedLight& misplaced, double apart, int spp) {
    if (field.light_square.empty()) return;
    HiddenError hidden(field.image, misplaced, apart);
    std::erase_if(pixels, [&](std::uint32_t k) {
        return noise_of_rays(field.image, k, field.light_square[k], spp) >
               hidden.at(k, HiddenError::shares(field, k));
    });
}

/// Scattering costs about as much as so many views of the whole picture, so that it pays for few views only
/// where it saves most of the picture.
constexpr double scatter_costs_views = 200;

}  // namespace

HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings) {
    FocusFrame frame(file);
    return hybrid_picture(frame, settings);
}

HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings) {
    const SampleFileReader& file = frame.file();
    const SampleHeader& h = file.header();
    FocusSettings focus = settings.focus;
    if (focus.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments,
             "--framing: hybrid and shoot keep the framing of the trace (expected keep)");
    }
    check_has_points(focus.impulse);
    if (settings.scene != nullptr) check_exposed_alike(*settings.scene, file);
    check_crop(focus.crop, h.width, h.height);
    // Which pixels are traced again, and with which others, is decided over the whole picture.
    if (settings.scene != nullptr) focus.crop.reset();
    const auto drawn = static_cast<double>(wanted_pixels(focus.crop, h.width, h.height));
    const std::string camera = settings.scene != nullptr ? checked_camera(h, *settings.scene) : "";
    const FocusGeometry geometry = focus_geometry(focus.lens, focus.focus_distance_m, Framing::keep,
                                                  {h.film_distance_mm, h.pixel_pitch_mm});
    const bool moves = settings.motion != nullptr && settings.shutter;
    HybridResult out;
    FieldFocusSettings by_field{
        geometry,  read_aperture(focus.impulse), {0, h.width, 0, h.height}, focus.views, {}, {}, {},
        focus.crop};
    MisplacedLight misplaced(h, geometry);
    by_field.also.rows = [&](const RecordBand& band, int y_begin, int y_end) {
        misplaced.add(band, y_begin, y_end);
    };
    if (!moves) by_field.leave_out_from_share = scatter_costs_views / std::max(focus.views, 1);
    if (moves)
        by_field.shutter = {settings.motion, settings.shutter->open_s, settings.shutter->close_s,
                            settings.curve};
    const FieldFocus field = field_focus(frame, by_field);
    out.what.assign(field.unknown.size(), 0);
    if (std::find(field.left_out.begin(), field.left_out.end(), 1) != field.left_out.end()) {
        focus.method = FocusMethod::scatter;
        focus.spacing = DepthSpacing::inverse;
        focus.depths.reset();
        out.focus = focus_picture(frame, focus);
        std::size_t scattered = 0;
        for (std::size_t k = 0; k < field.left_out.size(); ++k) {
            if (field.left_out[k] != 0) {
                const auto width = static_cast<std::size_t>(h.width);
                if (!focus.crop ||
                    focus.crop->contains(static_cast<int>(k % width), static_cast<int>(k / width)))
                    ++scattered;
                out.what[k] = 1;
                continue;
            }
            std::copy_n(field.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k), 3,
                        out.focus.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k));
        }
        out.scattered_share = static_cast<double>(scattered) / drawn;
    } else {
        out.focus.image = field.image;
        out.focus.largest_coc_px = largest_coc_px(depth_range(file), geometry);
    }
    out.focus.image.exposure_stops = file.exposure_stops();
    out.focus.views = focus.views;
    out.focus.geometry = geometry;
    std::vector<std::uint32_t> pixels =
        insufficient(field, misplaced.picture(), settings.tolerated, focus.crop);
    out.wanted_share = static_cast<double>(pixels.size()) / drawn;
    if (settings.scene != nullptr) {
        leave_to_views(pixels, field, misplaced, apart_px(file, geometry, moves), settings.retrace_spp);
        limit_retraced(settings.most_retraced, pixels, out);
        retrace(*settings.scene, retrace_settings(h, settings, camera, by_field.aperture), std::move(pixels),
                out);
    } else if (out.wanted_share > 1e-3) {
        out.focus.warnings.push_back(
            {"uncovered", out.wanted_share,
             fmt::format("the records do not suffice for {} % of the pixels (expected --scene, to trace them "
                         "again, or a trace with --hidden-layers for this lens)",
                         rough(100 * out.wanted_share))});
    }
    return out;
}

}  // namespace postlens
