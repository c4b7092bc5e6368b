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

/// Limit above which the sample file is insufficient for a pixel. It applies to two errors of the pixel: the
/// fraction of its light that comes from surfaces that are not recorded, and the radiance that reprojection
/// from the pinhole to the lens points moves to wrong positions.
constexpr double tolerated = 0.02;

/// Returns the fraction of the pixels, in the image or crop, for which the sample file is insufficient. A
/// pixel counts if the fraction of its light without a record (in `field`) or the radiance that is
/// reprojected to wrong positions (`misplaced`) exceeds `tolerated`.
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

/// Estimated time to make an image by the method `scatter`, as a multiple of the time to draw one view (image
/// from one lens point). It decides whether the use of `scatter` saves time.
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

/// Squared error of sRGB values that is not visible. It corresponds to a PSNR of 50 dB. Rays replace recorded
/// colours to reduce their error, but not where it is below this limit.
constexpr double fine_mse = 1e-5;

/// Finds the tiles in which rays should trace the highlights (bright spots that the lens blurs over many
/// pixels). In these tiles, the measured error of the blurred light exceeds both twice its standard deviation
/// and the noise of traced highlights. Returns 1 for these tiles.
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

/// Makes the image from colours in the sample file and from traced rays. The rays also measure the error of
/// the file's colours. In tiles where this error is large compared with the noise, rays replace all of these
/// colours.
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
