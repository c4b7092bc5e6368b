#include "planner/hybrid.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

#include "core/error.h"
#include "core/text.h"
#include "focus/bend_warning.h"
#include "focus/depth_levels.h"
#include "planner/retrace.h"
#include "planner/stated_error.h"
#include "planner/tile_grid.h"
#include "records/aperture_file.h"
#include "records/crop.h"
#include "tracer/render_setup.h"
#include "tracer/scene_rays.h"

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

/// Scattering costs about as much as so many views of the whole picture, so that it pays for few views only
/// where it saves most of the picture.
constexpr double scatter_costs_views = 200;

/// What the records alone tell.
HybridResult from_records(FocusFrame& frame, const HybridSettings& settings, FieldFocusSettings by_field) {
    const SampleFileReader& file = frame.file();
    const SampleHeader& h = file.header();
    FocusSettings focus = settings.focus;
    const auto drawn = static_cast<double>(wanted_pixels(focus.crop, h.width, h.height));
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
        out.focus.largest_coc_px = largest_coc_px(depth_range(file), by_field.geometry);
    }
    const std::size_t pixels =
        insufficient(field, misplaced.picture(), settings.tolerated, focus.crop).size();
    out.wanted_share = static_cast<double>(pixels) / drawn;
    if (out.wanted_share > 1e-3) {
        out.focus.warnings.push_back(
            {"uncovered", out.wanted_share,
             fmt::format("the records do not suffice for {} % of the pixels (expected --scene, for rays to "
                         "look there, or a trace with --hidden-layers for this lens)",
                         rough(100 * out.wanted_share))});
    }
    return out;
}

/// Of two halves, pixel by pixel, by what they are worth.
void mix(const std::vector<float>& from, double share, std::vector<float>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += static_cast<float>(share) * (from[i] - to[i]);
}

/// Puts tiles of another drawing in their place.
void replace_tiles(const std::vector<std::uint8_t>& which, FieldFocus&& from, FieldFocus& to) {
    const TileGrid grid{to.image.width, to.image.height};
    for (int y = 0; y < to.image.height; ++y) {
        for (int x = 0; x < to.image.width; ++x) {
            if (which[grid.at(x, y)] == 0) continue;
            const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(to.image.width) +
                           static_cast<std::size_t>(x);
            std::copy_n(from.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k), 3,
                        to.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k));
            to.traced[k] = from.traced[k];
            const std::uint32_t rays = to.checks[k].rays;
            to.checks[k] = {};  // nothing is left to the records
            to.checks[k].rays = rays;
        }
    }
}

/// Tiles whose views are scrambled independently, across and down: neighbours have errors of their own, and
/// there are as many to tell the noise by. Where things move, where they lie in all views takes too long.
constexpr int scrambles_across = 4, scrambles = scrambles_across * scrambles_across;
int scramble_of(int x, int y) {
    return y / TileGrid::edge % scrambles_across * scrambles_across + x / TileGrid::edge % scrambles_across;
}

/// With the scene: in two halves, so that their difference tells the noise.
HybridResult with_rays(FocusFrame& frame, const HybridSettings& settings, FieldFocusSettings by_field) {
    const SampleHeader& h = frame.file().header();
    const RenderSettings render =
        retrace_settings(h, settings, checked_camera(h, *settings.scene), by_field.aperture);
    const RenderSetup setup(*settings.scene, render);
    const SceneRays rays(setup, render.tracing, std::max(settings.focus.views, 1));
    by_field.rays = &rays;
    const bool moves = by_field.shutter.has_value();
    const FieldFocuser focuser(frame, by_field);
    const int second = settings.focus.views / 2, first = settings.focus.views - second;
    std::vector<FieldViews> halves;
    for (std::size_t half = 0; half < (second > 0 ? 2U : 1U); ++half) {
        const int count = half == 0 ? first : second;
        for (int scramble = 0; scramble < (moves ? 1 : scrambles); ++scramble) {
            FieldViews views{.count = count, .set = 2 * scramble + static_cast<int>(half), .picture = half};
            if (!moves)
                views.wanted = [scramble](int x, int y, int, int) { return scramble_of(x, y) == scramble; };
            views.checked = settings.checked
                                ? settings.checked
                                : [half, count](int x, int y, std::vector<std::uint32_t>& some) {
                                      CheckedPixels::views(x, y, static_cast<int>(half), count, some);
                                  };
            halves.push_back(std::move(views));
        }
    }
    std::vector<FieldFocus> drawn = focuser.draw(halves);
    HybridResult out;
    if (drawn.size() == 2 && !settings.checked) {
        const std::vector<std::uint8_t> biased = biased_tiles(drawn[0], drawn[1]);
        if (std::find(biased.begin(), biased.end(), 1) != biased.end()) {
            const TileGrid grid{h.width, h.height};
            for (FieldViews& views : halves) {
                views.wanted = [&, before = views.wanted](int x, int y, int width, int height) {
                    return biased[grid.at(x, y)] != 0 && (!before || before(x, y, width, height));
                };
                views.left_to_rays = [](int, int) { return true; };
                views.checked = nullptr;
            }
            std::vector<FieldFocus> again = focuser.draw(halves);
            for (std::size_t i = 0; i < 2; ++i) replace_tiles(biased, std::move(again[i]), drawn[i]);
        }
        out.stated = stated_error(drawn[0], drawn[1], settings.focus.crop);
    }
    FieldFocus& all = drawn[0];
    if (drawn.size() == 2) {
        const double share = static_cast<double>(second) / settings.focus.views;
        mix(drawn[1].image.rgb, share, all.image.rgb);
        mix(drawn[1].traced, share, all.traced);
        for (std::size_t k = 0; k < all.checks.size(); ++k) {
            for (std::size_t c = 0; c < 3; ++c) all.checks[k].sum[c] += drawn[1].checks[k].sum[c];
            all.checks[k].views += drawn[1].checks[k].views;
            all.checks[k].rays += drawn[1].checks[k].rays;
        }
    }
    out.what.assign(all.traced.size(), 0);
    for (std::size_t k = 0; k < all.traced.size(); ++k) {
        if (all.traced[k] > 0.5F) out.what[k] = 2;
    }
    const std::vector<float> asked = cut(all.traced, h.width, settings.focus.crop);
    out.retraced_share = std::accumulate(asked.begin(), asked.end(), 0.0) / static_cast<double>(asked.size());
    out.rays = rays.counts();
    out.focus.image = std::move(all.image);
    out.focus.largest_coc_px = largest_coc_px(depth_range(frame.file()), by_field.geometry);
    out.traced = std::move(all.traced);
    out.checks = std::move(all.checks);
    return out;
}

}  // namespace

HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings) {
    FocusFrame frame(file);
    return hybrid_picture(frame, settings);
}

HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings) {
    const SampleFileReader& file = frame.file();
    const SampleHeader& h = file.header();
    const FocusSettings& focus = settings.focus;
    if (focus.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments,
             "--framing: hybrid and shoot keep the framing of the trace (expected keep)");
    }
    check_has_points(focus.impulse);
    if (settings.scene != nullptr) check_exposed_alike(*settings.scene, file);
    check_crop(focus.crop, h.width, h.height);
    const FocusGeometry geometry = focus_geometry(focus.lens, focus.focus_distance_m, Framing::keep,
                                                  {h.film_distance_mm, h.pixel_pitch_mm});
    FieldFocusSettings by_field{
        geometry,  read_aperture(focus.impulse), {0, h.width, 0, h.height}, focus.views, {}, {}, {},
        focus.crop};
    if (settings.motion != nullptr && settings.shutter)
        by_field.shutter = {settings.motion, settings.shutter->open_s, settings.shutter->close_s,
                            settings.curve};
    HybridResult out = settings.scene != nullptr ? with_rays(frame, settings, std::move(by_field))
                                                 : from_records(frame, settings, std::move(by_field));
    out.focus.image.exposure_stops = file.exposure_stops();
    out.focus.views = focus.views;
    out.focus.geometry = geometry;
    return out;
}

}  // namespace postlens
