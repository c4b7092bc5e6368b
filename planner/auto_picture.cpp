#include "planner/auto_picture.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <queue>

#include "core/error.h"
#include "core/text.h"
#include "planner/errors/records_bound.h"
#include "planner/stated_error.h"
#include "planner/views/halved_views.h"
#include "planner/views/picture_request.h"

namespace postlens {
namespace {

/// Number of views of every tile at the beginning: 8 for each of the image's two independent halves.
constexpr int first_views = 16;

double db_of(double mse) {
    return -10 * std::log10(std::max(mse, 1e-12));
}

/// Plans the next step. Doubles the number of views of some tiles, at most once per tile, until the expected
/// mean noise is below `wanted_mse`. Tiles where an added view removes most noise come first. Doubling the
/// views is assumed to halve the squared noise of a tile.
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
    std::vector<int> planned = views;
    std::priority_queue<Step> steps;
    double left = 0;
    const auto noise = [&](std::size_t t) { return tiles[t].noise_mse * views[t] / planned[t]; };
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        left += noise(t) * grid.pixels(t) / pixels;
        steps.push({noise(t) / planned[t], t});
    }
    while (left > wanted_mse && !steps.empty() && steps.top().gain > 0) {
        const std::size_t t = steps.top().tile;
        steps.pop();
        if (2 * planned[t] > most_lens_views) continue;
        left -= noise(t) / 2 * grid.pixels(t) / pixels;
        planned[t] *= 2;
        steps.push({noise(t) / planned[t], t});
    }
    for (std::size_t t = 0; t < planned.size(); ++t) planned[t] = std::min(planned[t], 2 * views[t]);
    return planned;
}

/// Selects the tiles in which rays replace all samples of views, because the records themselves are in error.
/// The tiles with the largest errors are selected, until the error of the remaining tiles is a quarter of the
/// target.
std::vector<std::uint8_t> most_biased(const std::vector<TileError>& tiles, const TileGrid& grid,
                                      double most_mse) {
    std::vector<std::size_t> order;
    const double pixels = static_cast<double>(grid.width) * grid.height;
    double bias = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        bias += tiles[t].bias_mse * grid.pixels(t) / pixels;
        if (tiles[t].bias_mse > 0) order.push_back(t);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return tiles[a].bias_mse * grid.pixels(a) > tiles[b].bias_mse * grid.pixels(b);
    });
    std::vector<std::uint8_t> out(tiles.size(), 0);
    for (const std::size_t t : order) {
        if (bias <= most_mse / 4) break;
        bias -= tiles[t].bias_mse * grid.pixels(t) / pixels;
        out[t] = 1;
    }
    return out;
}

}  // namespace

double AutoResult::noise_db() const {
    return db_of(noise_mse);
}
double AutoResult::bound_db() const {
    return db_of(bound_mse);
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
    std::vector<TileError> tiles;
    for (;;) {
        views.draw(wanted);
        tiles = tile_errors(views.half(0), views.half(1));
        StatedError error = stated_error(views.half(0), views.half(1), {}, CheckedPixels::Use::deciding);
        if (views.has_rays()) {
            std::vector<std::uint8_t> biased = biased_tiles(tiles);
            // More views do not reduce the error of the records. If this error exceeds a quarter of the
            // target, replacing views by rays is cheaper.
            if (error.bias_mse - error.highlights_mse > most_mse / 4) {
                const std::vector<std::uint8_t> more = most_biased(tiles, grid, most_mse);
                for (std::size_t t = 0; t < biased.size(); ++t) biased[t] |= more[t];
            }
            views.leave_to_rays(biased);
            tiles = tile_errors(views.half(0), views.half(1));
            error = stated_error(views.half(0), views.half(1), {}, CheckedPixels::Use::deciding);
        }
        if (error.high_mse <= most_mse) break;
        const double others = error.high_mse - error.noise_mse;
        std::vector<int> next = doubled(wanted, tiles, grid, std::max(most_mse - others, most_mse / 2));
        if (next == wanted) break;
        wanted = std::move(next);
    }

    AutoResult out;
    out.grid = grid;
    double pixels = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        out.tiles.push_back({wanted[t], views.left_to_rays()[t] != 0, tiles[t].noise_mse});
        out.mean_views += static_cast<double>(wanted[t]) * grid.pixels(t);
        pixels += grid.pixels(t);
    }
    out.mean_views /= pixels;
    const auto [least, most] = std::minmax_element(wanted.begin(), wanted.end());
    const bool has_rays = views.has_rays();
    const StatedError stated = stated_error(views.half(0), views.half(1), crop);
    out.hybrid = finished(frame, std::move(views), crop);
    out.hybrid.focus.views = *most;
    out.hybrid.focus.method = FocusMethod::hybrid;
    out.plan = fmt::format("{} to {} views a tile, {:.0f} on the mean: ", *least, *most, out.mean_views);
    std::string reason;
    if (has_rays) {
        out.hybrid.stated = stated;
        out.met = stated.mse() <= most_mse;
        out.plan +=
            fmt::format("{:.1f} dB ({:.1f} to {:.1f})", stated.db(), stated.low_db(), stated.high_db());
        reason = fmt::format("{:.1f} dB are stated", stated.db());
        reason += *most == most_lens_views
                      ? fmt::format(", with {} views (expected a lower target)", most_lens_views)
                      : ", by rays that decided nothing (expected a somewhat higher target)";
    } else {
        const RecordsBound bound = records_bound(frame, whole, out.hybrid.focus.image);
        out.unsure_share = bound.unsure_share(grid.width, crop);
        out.noise_mse = stated.noise_mse;
        out.bound_mse = together_mse(stated.noise_mse, bound.mean_mse(grid.width, crop));
        out.met = out.noise_mse <= most_mse;
        const std::string said = fmt::format(
            "{:.1f} dB beside what the records are not sure of, {} % of what the lens sees, and at "
            "least {:.1f} dB",
            out.noise_db(), rough(100 * out.unsure_share), out.bound_db());
        out.plan += said;
        if (settings.target_db && out.met && out.bound_mse > most_mse) {
            out.hybrid.focus.warnings.push_back(
                {"unsure", out.unsure_share, said + " (expected --scene, for rays to look there)"});
        }
        reason = fmt::format("{:.1f} dB are reached with {} views (expected a lower target)", out.noise_db(),
                             *most);
    }
    if (!out.met) out.hybrid.focus.warnings.push_back({"target", 1, reason});
    return out;
}

}  // namespace postlens
