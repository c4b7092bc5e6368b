#include "planner/auto_picture.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <queue>

#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "core/threads.h"
#include "pictures/crop.h"
#include "pictures/srgb.h"
#include "planner/errors/records_bound.h"
#include "planner/stated_error.h"
#include "planner/views/halved_views.h"
#include "planner/views/picture_request.h"

namespace postlens {
namespace {

/// Number of views (images from different lens points) with which every tile starts. They form two halves of
/// 8 views, whose difference shows the noise.
constexpr int first_views = 16;

/// Largest factors by which the total number of views (images from different lens points) may grow to narrow
/// the confidence interval of the image's error. `most_narrowing_of_noise` applies if no rays measure the
/// error of the recorded colours, but only the views' noise is measured.
constexpr double most_narrowing = 8, most_narrowing_of_noise = 2;

/// Returns the total number of samples that an image needs: the number of pixels in all its views (images
/// from different lens points) together. `views` contains the number of views of each tile of `grid`.
double samples(const std::vector<int>& views, const TileGrid& grid) {
    double sum = 0;
    for (std::size_t t = 0; t < views.size(); ++t) sum += static_cast<double>(views[t]) * grid.pixels(t);
    return sum;
}

/// Increases the number of views (images from different lens points) of the image's tiles, so that the
/// image's expected squared error falls below `wanted_mse`. Repeatedly doubles the views of the tile in which
/// each added view reduces the squared error most.
std::vector<int> doubled(const std::vector<int>& views, const std::vector<TileError>& tiles,
                         const TileGrid& grid, double wanted_mse) {
    struct Step {
        double gain = 0;  ///< squared error that each added view removes, per pixel
        std::size_t tile = 0;
        bool operator<(const Step& other) const {
            return gain != other.gain ? gain < other.gain : tile > other.tile;
        }
    };
    const double pixels = static_cast<double>(grid.width) * grid.height;
    const auto expected = [&](std::size_t t, int of_views) {
        return tiles[t].noise_mse * views[t] / of_views;
    };
    std::vector<int> planned = views;
    std::priority_queue<Step> steps;
    const auto gain = [&](std::size_t t) {
        return (expected(t, planned[t]) - expected(t, 2 * planned[t])) / planned[t];
    };
    double left = 0;
    for (std::size_t t = 0; t < views.size(); ++t) {
        left += expected(t, planned[t]) * grid.pixels(t) / pixels;
        steps.push({gain(t), t});
    }
    while (left > wanted_mse && !steps.empty() && steps.top().gain > 0) {
        const std::size_t t = steps.top().tile;
        steps.pop();
        if (2 * planned[t] > most_lens_views) continue;
        left -= (expected(t, planned[t]) - expected(t, 2 * planned[t])) * grid.pixels(t) / pixels;
        planned[t] *= 2;
        steps.push({gain(t), t});
    }
    // No tile gets more than twice its present number of views.
    for (std::size_t t = 0; t < planned.size(); ++t) planned[t] = std::min(planned[t], 2 * views[t]);
    return planned;
}

std::vector<std::uint8_t> least_known(const std::vector<TileError>& tiles, const TileGrid& grid,
                                      double most_variance) {
    return largest_tiles(tiles, grid, most_variance, [](const TileError& tile, double share) {
        return tile.bias_deviation * tile.bias_deviation * share * share;
    });
}

/// Returns 1 for the tiles of the image in which rays should trace the highlights (small or blurred bright
/// surfaces). In all other tiles, the lens's point spread function spreads their light over the image, which
/// causes some error.
std::vector<std::uint8_t> misplaced_highlights(const HalvedViews& views, const MeasuredError& measured,
                                               double most_mse) {
    const TileGrid& grid = views.grid();
    const std::vector<double> noise =
        highlights_noise(views.half(0), views.half(1), grid, std::vector<int>(grid.count(), most_lens_views));
    std::vector<TileError> tiles = measured.tiles;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        // A tile is not selected if traced highlights would have much noise, or if the error does not exceed
        // its own standard deviation. A stricter test is not needed, because only tiles with much of the
        // image's error are selected.
        if (tiles[t].highlights_mse <= tiles[t].highlights_deviation || noise[t] > most_mse)
            tiles[t].highlights_mse = 0;
    }
    return largest_tiles(tiles, grid, most_mse / 4,
                         [](const TileError& tile, double share) { return tile.highlights_mse * share; });
}

/// Increases the number of views (images from different lens points) in some tiles, to narrow the confidence
/// interval of the image's error. The views are doubled where this narrows the interval most, until it is
/// narrow enough or all views would need more than `most_samples` pixels.
std::vector<int> narrowed(const std::vector<int>& views, const std::vector<TileError>& tiles,
                          const TileGrid& grid, const StatedError& error, double most_samples) {
    const double pixels = static_cast<double>(grid.width) * grid.height;
    struct Step {
        double mse = 0, variance = 0;  ///< decrease of the error and of its variance
        std::size_t tile = 0;
    };
    std::vector<Step> steps;
    for (std::size_t t = 0; t < views.size(); ++t) {
        const double share = grid.pixels(t) / pixels, mse = tiles[t].noise_mse;
        if (2 * views[t] > most_lens_views || !(mse > 0)) continue;
        constexpr double left = 0.5;  // of the error, as in doubled()
        steps.push_back(
            {share * mse * (1 - left), share * share * tiles[t].noise_variance * (1 - left * left), t});
    }
    std::stable_sort(steps.begin(), steps.end(),
                     [](const Step& a, const Step& b) { return a.variance * b.mse > b.variance * a.mse; });
    // The image's error is measured, and its 95 % confidence interval should be at most wanted_interval_db
    // wide. The width after more views are drawn can only be predicted, and may then be measured as larger.
    // So the prediction must be 10 % narrower than wanted.
    constexpr double aim_db = 0.9 * wanted_interval_db;
    double mse = error.mse(), variance = error.variance, least_db = error.width_db();
    double left = most_samples - samples(views, grid);
    std::size_t best = 0;  // number of steps that make the interval narrowest
    for (std::size_t i = 0; i < steps.size() && least_db > aim_db; ++i) {
        const std::size_t t = steps[i].tile;
        left -= static_cast<double>(views[t]) * grid.pixels(t);
        if (left < 0) break;
        mse -= steps[i].mse;
        variance = std::max(0.0, variance - steps[i].variance);
        if (!(mse > 0)) break;
        const double width_db = StatedError::width_db(mse, variance);
        if (width_db >= least_db) continue;
        least_db = width_db;
        best = i + 1;
    }
    std::vector<int> planned = views;
    for (std::size_t i = 0; i < best; ++i) planned[steps[i].tile] *= 2;
    return planned;
}

}  // namespace

double AutoResult::noise_db() const {
    return stated_db(noise_mse);
}
double AutoResult::bound_db() const {
    return stated_db(bound_mse);
}

AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings) {
    const double target_db = settings.target_db.value_or(default_target_db);
    if (!(target_db >= 10 && target_db <= 80))
        fail(ExitCode::wrong_arguments, "--target-db: out of range (got {}; expected 10 to 80)", target_db);
    check_request(frame.file(), settings.hybrid, "auto");
    const std::optional<Crop>& crop = settings.hybrid.focus.crop;
    HybridSettings whole = settings.hybrid;
    whole.focus.crop.reset();
    whole.checked = nullptr;
    HalvedViews views(frame, whole);
    const TileGrid& grid = views.grid();
    const double most_mse = std::pow(10.0, -target_db / 10);
    std::vector<int> wanted(grid.count(), first_views);
    MeasuredError measured;
    const auto measure = [&](const std::optional<Crop>& where, CheckedPixels::Use use) {
        return measured_error(views.half(0), views.half(1), where, views.checked_pixels(), use);
    };
    bool is_met = false;
    double most_samples = 0;  // limit for narrowing the interval; 0 until the target is met
    for (;;) {
        views.draw(wanted);
        measured = measure({}, CheckedPixels::Use::deciding);
        if (views.has_rays()) {
            if (views.leave_to_rays(misplaced_highlights(views, measured, most_mse),
                                    LeftToRays::samples_and_lights))
                measured = measure({}, CheckedPixels::Use::deciding);
            // More views reduce the noise, but not the errors of the colours that the sample file records. So
            // rays trace the colours in the tiles where these errors are largest. In all other tiles
            // together, the errors are at most a quarter of the target error.
            if (views.leave_to_rays(biased_tiles(measured, grid, most_mse / 4, most_mse),
                                    LeftToRays::samples))
                measured = measure({}, CheckedPixels::Use::deciding);
        }
        const StatedError error = stated_error(measured);
        const auto doubled_for = [&](double goal) {
            const double others = error.high_mse - error.views_mse;
            return doubled(wanted, measured.tiles, grid, std::max(goal - others, goal / 2));
        };
        std::vector<int> next = wanted;
        is_met = error.high_mse <= most_mse;
        if (!is_met) {
            // A low estimate of the error of the highlights (small or blurred bright surfaces): the measured
            // error minus a standard deviation.
            const double of_highlights = measured.highlights_mse - std::sqrt(measured.bias_variance);
            // More views do not reduce the error of the highlights. So the views aim at the target error
            // `most_mse`, or at half of the highlights' error if that is larger.
            next = doubled_for(std::max(most_mse, of_highlights / 2));
        } else if (error.width_db() > wanted_interval_db) {
            if (measured.bias_variance > error.variance / 4 &&
                views.leave_to_rays(least_known(measured.tiles, grid, measured.bias_variance / 2),
                                    LeftToRays::samples))
                continue;
            const double drawn = samples(wanted, grid);
            const bool is_first = most_samples == 0;
            if (is_first)
                most_samples = drawn * (views.has_rays() ? most_narrowing : most_narrowing_of_noise);
            // Normally, some tiles get more views than others. But with 32 views per tile or fewer, the error
            // of a single tile is measured too inaccurately to decide which tiles need more. So the number of
            // views is then doubled in every tile.
            const bool all = is_first && drawn <= 2.0 * first_views * grid.width * grid.height;
            next = all ? doubled_for(0) : narrowed(wanted, measured.tiles, grid, error, most_samples);
        }
        if (next == wanted) break;
        wanted = std::move(next);
    }

    AutoResult out;
    out.grid = grid;
    for (std::size_t t = 0; t < grid.count(); ++t) {
        out.tiles.push_back(
            {wanted[t], views.left_to_rays()[t] != LeftToRays::unsure, measured.tiles[t].noise_mse});
    }
    out.mean_views = samples(wanted, grid) / (static_cast<double>(grid.width) * grid.height);
    const auto [least, most] = std::minmax_element(wanted.begin(), wanted.end());
    const bool has_rays = views.has_rays();
    const StatedError stated = stated_error(measure(crop, CheckedPixels::Use::stating));
    out.hybrid = finished(frame, std::move(views), crop);
    out.hybrid.focus.views = *most;
    out.hybrid.focus.method = FocusMethod::hybrid;
    out.plan = *least == *most ? counted(*most, "view") + " a tile: "
                               : fmt::format("{} to {} views a tile, {:.0f} on the mean: ", *least, *most,
                                             out.mean_views);
    std::string reason;
    if (has_rays) {
        out.hybrid.stated = stated;
        out.met = stated.mse() <= most_mse;
        out.plan +=
            fmt::format("{:.1f} dB ({:.1f} to {:.1f})", stated.db(), stated.low_db(), stated.high_db());
        reason = fmt::format("{:.1f} dB are stated", stated.db());
        if (*most == most_lens_views) {
            reason += fmt::format(", with {} (expected a lower target)", counted(most_lens_views, "view"));
        } else if (stated.highlights_mse > stated.mse() / 2) {
            reason += fmt::format(
                ": highlights have an error of {:.1f} dB, which neither views nor rays reduce (expected a "
                "lower target{})",
                stated_db(stated.highlights_mse),
                whole.shutter && frame.file().instants() == 1 ? ", or `trace --keys`" : "");
        } else if (!is_met) {
            reason += ", and neither more views nor rays reduce the error (expected a lower target)";
        } else {
            reason += ", by rays that decided nothing (expected a somewhat higher target)";
        }
    } else {
        const RecordsBound bound = records_bound(frame, whole, out.hybrid.focus.image);
        out.unsure_share = mean_of(bound.unsure, grid.width, crop);
        out.noise_mse = stated.views_mse;
        out.bound_mse = together_mse(stated.views_mse, mean_of(bound.mse, grid.width, crop));
        out.met = out.noise_mse <= most_mse;
        const std::string said = fmt::format(
            "{:.1f} dB without the error of the records, at least {:.1f} dB with it, as {} % of the view "
            "samples are unsure",
            out.noise_db(), out.bound_db(), rough(100 * out.unsure_share));
        out.plan += said;
        if (settings.target_db && out.met && out.bound_mse > most_mse) {
            out.hybrid.focus.warnings.push_back(
                {"unsure", out.unsure_share, said + " (expected --scene, for rays in their place)"});
        }
        reason = fmt::format("{:.1f} dB are reached with {} (expected a lower target)", out.noise_db(),
                             counted(*most, "view"));
    }
    if (!out.met) out.hybrid.focus.warnings.push_back({"target", 1, reason});
    return out;
}

}  // namespace postlens
