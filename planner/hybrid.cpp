#include "planner/hybrid.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "core/text.h"
#include "focus/bend_warning.h"
#include "focus/responses/depth_levels.h"
#include "pictures/crop.h"
#include "planner/stated_error.h"
#include "planner/views/halved_views.h"
#include "planner/views/picture_request.h"

namespace postlens {
namespace {

/// Limit for two errors of a pixel in an image made from the sample file: the fraction of its light that is
/// not recorded in the file, and the radiance that is reprojected from the pinhole image to a wrong position.
/// If one of them is larger, the sample file is insufficient for this pixel.
constexpr double tolerated = 0.02;

/// Returns the fraction of the pixels, in the image or crop, for which the sample file is insufficient:
/// either too much of their light is not recorded in the file (`field`), or too much light is reprojected to
/// a wrong position (`misplaced`, radiance per pixel). The limit is `tolerated`.
double insufficient_share(const FieldFocus& field, const std::vector<float>& misplaced,
                          const std::optional<Crop>& crop) {
    std::vector<std::uint8_t> marks(field.unknown.size());
    for (std::size_t k = 0; k < marks.size(); ++k) {
        const float error =
            std::max({field.unknown[k], field.unknown_below[k], misplaced.empty() ? 0.0F : misplaced[k]});
        marks[k] = static_cast<double>(error) > tolerated ? 1 : 0;
    }
    return mean_of(marks, field.image.width, crop);
}

/// Time of the method `scatter`, in multiples of the time for one view (image from one lens point).
constexpr double scatter_costs_views = 200;

/// Makes the image from the records alone, without rays.
HybridResult from_records(FocusFrame& frame, const HybridSettings& settings) {
    FieldFocusSettings by_field = field_settings(frame.file().header(), settings);
    const SampleFileReader& file = frame.file();
    const SampleHeader& h = file.header();
    FocusSettings focus = settings.focus;
    HybridResult out;
    MisplacedLight misplaced(h, by_field.geometry);
    by_field.also.rows = [&](const RecordBand& band, int y_begin, int y_end) {
        misplaced.add(band, y_begin, y_end);
    };
    if (!by_field.shutter) by_field.leave_out_from_share = scatter_costs_views / std::max(focus.views, 1);
    const FieldFocus field = field_focus(frame, by_field);
    out.what.assign(field.unknown.size(), 0);
    if (std::find(field.left_out.begin(), field.left_out.end(), 1) != field.left_out.end()) {
        focus.method = FocusMethod::scatter;
        focus.spacing = DepthSpacing::inverse;
        focus.depths.reset();
        out.focus = focus_picture(frame, focus);
        for (std::size_t k = 0; k < field.left_out.size(); ++k) {
            if (field.left_out[k] != 0) {
                out.what[k] = 1;
                continue;
            }
            std::copy_n(field.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k), 3,
                        out.focus.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k));
        }
        out.scattered_share = mean_of(out.what, h.width, focus.crop);
    } else {
        out.focus.image = field.image;
        out.focus.image.exposure_stops = file.exposure_stops();
        out.focus.geometry = by_field.geometry;
        out.focus.largest_coc_px = largest_coc_px(depth_range(file), by_field.geometry);
    }
    out.wanted_share = insufficient_share(field, misplaced.picture(), focus.crop);
    if (out.wanted_share > 1e-3) {
        out.focus.warnings.push_back(
            {"uncovered", out.wanted_share,
             fmt::format("the records do not suffice for {} % of the pixels (expected --scene, for rays to "
                         "look there, or a trace with --hidden-layers for this lens{})",
                         rough(100 * out.wanted_share),
                         settings.shutter ? ", or with --keys for this shutter" : "")});
    }
    return out;
}

/// Squared error that corresponds to a PSNR of 50 dB. Smaller errors are not visible, so rays need not reduce
/// them.
constexpr double fine_mse = 1e-5;

/// The light of highlights (small or blurred bright surfaces) is spread over the image by the lens's point
/// spread function, which may put some of it in wrong pixels. Returns 1 for the tiles in which this error is
/// larger than twice its standard deviation and than the noise that traced highlights would have. In these
/// tiles, rays should trace the highlights instead.
std::vector<std::uint8_t> misplaced_highlights(const HalvedViews& views, const MeasuredError& measured) {
    const std::vector<double> noise =
        highlights_noise(views.half(0), views.half(1), views.grid(), views.views());
    std::vector<std::uint8_t> out;
    for (std::size_t t = 0; t < noise.size(); ++t) {
        const TileError& tile = measured.tiles[t];
        out.push_back(tile.highlights_mse > std::max(2 * tile.highlights_deviation, noise[t]) ? 1 : 0);
    }
    return out;
}

/// Makes the image from recorded colours and rays, and measures the error of the recorded colours. In tiles
/// where this error is large compared with the noise, rays replace all recorded colours.
HybridResult with_rays(FocusFrame& frame, const HybridSettings& settings) {
    HalvedViews views(frame, settings);
    views.draw(std::vector<int>(views.grid().count(), settings.focus.views));
    std::optional<StatedError> stated;
    if (settings.focus.views > 1 && !settings.checked) {
        const auto measured = [&](const std::optional<Crop>& crop, CheckedPixels::Use use) {
            return measured_error(views.half(0), views.half(1), crop, views.checked_pixels(), use);
        };
        MeasuredError deciding = measured({}, CheckedPixels::Use::deciding);
        if (views.leave_to_rays(misplaced_highlights(views, deciding), LeftToRays::samples_and_lights))
            deciding = measured({}, CheckedPixels::Use::deciding);
        const double noise_mse = stated_error(deciding).views_mse;
        const bool is_known = deciding.bias_mse > 2 * std::sqrt(deciding.bias_variance);
        views.leave_to_rays(biased_tiles(deciding, views.grid(),
                                         is_known ? std::max(noise_mse / 8, fine_mse - noise_mse)
                                                  : std::numeric_limits<double>::infinity(),
                                         fine_mse),
                            LeftToRays::samples);
        stated = stated_error(measured(settings.focus.crop, CheckedPixels::Use::stating));
    }
    HybridResult out = finished(frame, std::move(views), settings.focus.crop);
    out.stated = stated;
    return out;
}

}  // namespace

HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings) {
    FocusFrame frame(file);
    return hybrid_picture(frame, settings);
}

HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings) {
    check_request(frame.file(), settings, "hybrid and shoot");
    HybridResult out = settings.scene != nullptr ? with_rays(frame, settings) : from_records(frame, settings);
    out.focus.views = settings.focus.views;
    return out;
}

}  // namespace postlens
