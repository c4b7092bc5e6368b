#include "planner/auto_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "core/error.h"
#include "core/threads.h"
#include "focus/field_focus.h"
#include "planner/hidden_error.h"
#include "planner/pilot.h"
#include "planner/record_floor.h"
#include "planner/retrace.h"
#include "planner/tile_choices.h"
#include "planner/weighed_rays.h"
#include "records/srgb.h"

namespace postlens {
namespace {

constexpr int pilot_views = 8;
constexpr int both_pilots = 2 * pilot_views;
/// Numbers of views that tiles are grouped by: more than needed by a fifth on the mean. The first is both
/// pilots together, to which the others add.
constexpr std::array<int, 14> ladder{both_pilots, 24,  32,  48,  64,  96,   128,
                                     192,         256, 384, 512, 768, 1024, 2048};
/// Of the tiles, what is aimed at: more than is promised, as chances are off themselves.
constexpr double aimed_share = 0.92;
/// Of the whole picture's error, what is aimed at.
constexpr double aimed_at = 0.9;
/// A choice that is at its target with such a chance needs neither more views nor rays.
constexpr double sure = 0.995;
/// What a pixel that is traced again costs, in pixels of views. The first rays alone are worth 110 to 420,
/// and where they are noisy there are many more (docs/planner.md).
constexpr double retraced_price = 1280;

class Planner {
  public:
    Planner(FocusFrame& frame, const AutoSettings& settings)
        : frame_(frame),
          settings_(settings),
          h_(frame.file().header()),
          most_mse_(std::pow(10.0, -settings.target_db / 10)) {
        out_.grid = {h_.width, h_.height};
        out_.tiles.resize(out_.grid.count());
    }

    AutoResult run() {
        HybridSettings whole = settings_.hybrid;
        whole.focus.crop.reset();
        Pilot pilot(frame_, whole, pilot_views);
        take(pilot);
        choose();
        draw(pilot.focuser());
        trace_again(pilot.aperture());
        sum_up(pilot.geometry());
        return std::move(out_);
    }

  private:
    /// What the pilot found, of which nothing is held twice.
    void take(Pilot& pilot) {
        aligned_ = std::move(pilot.aligned);
        spread_ = std::move(pilot.spread);
        floor_ = std::move(pilot.floor);
        hidden_ = std::move(pilot.hidden);
        const TileGrid& grid = out_.grid;
        pilot_noise_ = grid.means(pilot.noise);
        const std::vector<double> floor = grid.means(floor_), hidden = grid.means(hidden_);
        for (std::size_t t = 0; t < grid.count(); ++t) {
            out_.tiles[t].floor_mse = floor_unseen * floor[t];
            out_.tiles[t].hidden_mse = hidden[t];
        }
        Image& picture = out_.hybrid.focus.image;
        picture = std::move(pilot.a);
        const Image other = std::move(pilot.b);
        for (std::size_t i = 0; i < picture.rgb.size(); ++i)
            picture.rgb[i] = (picture.rgb[i] + other.rgb[i]) / 2;
        out_.hybrid.what.assign(hidden_.size(), 0);
        ray_noise_.assign(hidden_.size(), 0);
        for (std::size_t k = 0; k < pilot.light_square.size(); ++k)
            ray_noise_[k] =
                static_cast<float>(first_rays * noise_of_rays(picture, k, pilot.light_square[k], first_rays));
    }

    /// Of each tile how many views, and which of its pixels are then to be traced again.
    void choose() {
        const std::size_t tiles = out_.tiles.size();
        std::vector<std::vector<TileChoice>> choices(tiles);
        parallel_for(tiles, [&](std::size_t t) { choices[t] = choices_of(t); });
        const auto all = static_cast<double>(hidden_.size());
        const ChosenTiles chosen =
            cheapest_choices(choices, out_.grid,
                             {aimed_at * most_mse_, aimed_share, retraced_price,
                              static_cast<std::size_t>(settings_.hybrid.most_retraced * all)});
        std::vector<std::vector<std::uint32_t>> pixels(tiles);
        parallel_for(tiles, [&](std::size_t t) {
            const TileChoice& c = chosen.tiles[t];
            out_.tiles[t].views = c.views;
            out_.tiles[t].noise_mse = c.noise_mse;
            out_.tiles[t].chance = c.chance;
            // Without the scene what would be traced again is only told.
            const bool told = settings_.hybrid.scene == nullptr && c.chance < 0.5;
            if (c.retraced == 0 && !told) return;
            TileRest rest = rest_of(t);
            rest.pixels.resize(told ? rest.nearly_all() : c.retraced);
            pixels[t] = std::move(rest.pixels);
        });
        for (const auto& some : pixels) pixels_.insert(pixels_.end(), some.begin(), some.end());
        out_.hybrid.wanted_share = static_cast<double>(std::max(pixels_.size(), chosen.wanted)) / all;
    }

    /// By growing number of views, and for each of pixels that are traced again.
    [[nodiscard]] std::vector<TileChoice> choices_of(std::size_t t) const {
        const TileRest rest = rest_of(t);
        const bool has_scene = settings_.hybrid.scene != nullptr;
        const double all = out_.tiles[t].floor_mse + out_.tiles[t].hidden_mse, stays = all - rest.mean[0];
        // Where the rest alone is too much, views that add a third of it are as good as any; unless what
        // keeps the tile from its target can be traced again.
        const double little = std::max(0.1 * most_mse_, has_scene ? 0 : all / 3);
        std::vector<TileChoice> out;
        for (const int views : ladder) {
            const double noise = noise_of_views(pilot_noise_[t], pilot_views, views);
            const auto choice = [&](std::size_t retraced) {
                const double mse = noise + stays + rest.mean[retraced];
                return TileChoice{views, noise, retraced, mse,
                                  chance_of(mse, noise + stays + rest.at_worst[retraced], most_mse_)};
            };
            out.push_back(choice(0));
            if (out.back().chance >= sure) break;
            const std::size_t most = has_scene ? rest.nearly_all() : 0;
            for (std::size_t n = 1; n <= most && out.back().chance < sure; n += 1 + n / 4)
                out.push_back(choice(n));
            if (noise <= little) break;
        }
        return out;
    }

    [[nodiscard]] TileRest rest_of(std::size_t tile) const {
        return {out_.grid, tile, [this](std::uint32_t k) { return removed(k); },
                [this](std::uint32_t k) { return removed_at_worst(k); }};
    }

    /// What rays may make good of a pixel beside the noise of views, and what of that those do that it gets
    /// at first.
    [[nodiscard]] double error(std::uint32_t k) const {
        return static_cast<double>(hidden_[k]) + removed_floor(k);
    }
    /// What the lens spreads of a pixel's light is off in others.
    [[nodiscard]] double own_floor(std::uint32_t k) const {
        return floor_unseen * static_cast<double>(floor_[k] - spread_[k]);
    }
    [[nodiscard]] double removed_floor(std::uint32_t k) const { return (1 - still_unseen) * own_floor(k); }
    [[nodiscard]] double removed_part(std::uint32_t k) const {
        const double noise = static_cast<double>(ray_noise_[k]) / first_rays;
        return noise > 0 ? error(k) / (error(k) + noise) : 1;
    }
    [[nodiscard]] double removed(std::uint32_t k) const { return removed_part(k) * error(k); }
    /// The same, should the edges be worse than the mean.
    [[nodiscard]] double removed_at_worst(std::uint32_t k) const {
        return removed(k) +
               removed_part(k) * floor_unseen * (aligned_nine_in_ten - 1) * static_cast<double>(aligned_[k]);
    }

    /// Of each tile a set of its own, and the pilots' for what they are worth beside it: their noise chose
    /// the tile, and what happened to be small there is not small in the other again.
    void draw(const FieldFocuser& focuser) {
        std::map<int, float> shares;  // of the own set, by numbers of views
        for (const TilePlan& p : out_.tiles) {
            if (p.views == ladder.front()) continue;  // the pilots' mean is there already
            const double noise = noise_of_set(pilot_views, p.views - both_pilots);
            shares[p.views] = static_cast<float>(two_sets / (two_sets + noise));
        }
        if (shares.empty()) return;
        std::vector<FieldViews> sets;
        for (const auto& [views, share] : shares) {
            const auto wanted = [&, views = views](int x, int y, int /*width*/, int /*height*/) {
                return out_.tiles[out_.grid.at(x, y)].views == views;
            };
            sets.push_back({.count = views - both_pilots, .set = 2, .wanted = wanted});
        }
        const FieldFocus drawn = std::move(focuser.draw(sets).front());
        Image& picture = out_.hybrid.focus.image;
        for (int y = 0; y < h_.height; ++y) {
            for (int x = 0; x < h_.width; ++x) {
                const auto share = shares.find(out_.tiles[out_.grid.at(x, y)].views);
                if (share == shares.end()) continue;
                float* to = picture.pixel(x, y);
                const float* from = drawn.image.pixel(x, y);
                for (std::size_t c = 0; c < 3; ++c) to[c] += share->second * (from[c] - to[c]);
            }
        }
    }

    void trace_again(const Aperture& aperture) {
        HybridResult& hybrid = out_.hybrid;
        const HybridSettings& s = settings_.hybrid;
        if (s.scene == nullptr || pixels_.empty()) return;
        limit_retraced(s.most_retraced, pixels_, hybrid);
        trace_weighed(*s.scene, retrace_settings(h_, s, checked_camera(h_, *s.scene), aperture),
                      {pixels_, out_.grid, most_mse_, [this](std::uint32_t k) { return error_of_views(k); },
                       [this](std::uint32_t k) { return static_cast<double>(ray_noise_[k]); }},
                      hybrid);
        for (const std::uint32_t k : pixels_) {
            TilePlan& p = out_.tiles[tile_of(k)];
            const double pixel = 1.0 / out_.grid.pixels(tile_of(k)), part = pixel * removed_part(k);
            p.retraced += pixel;
            p.floor_mse = std::max(0.0, p.floor_mse - part * removed_floor(k));
            p.hidden_mse = std::max(0.0, p.hidden_mse - part * static_cast<double>(hidden_[k]));
        }
    }

    /// Of a pixel that is not traced again.
    [[nodiscard]] double error_of_views(std::uint32_t k) const {
        return static_cast<double>(hidden_[k]) + own_floor(k) + out_.tiles[tile_of(k)].noise_mse;
    }

    [[nodiscard]] std::size_t tile_of(std::size_t pixel) const {
        const auto width = static_cast<std::size_t>(h_.width);
        return out_.grid.at(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
    }

    void sum_up(const FocusGeometry& geometry) {
        double mse = 0, views = 0, met = 0;
        int least = ladder.back(), most = ladder.front();
        for (std::size_t t = 0; t < out_.tiles.size(); ++t) {
            const TilePlan& p = out_.tiles[t];
            const double share =
                static_cast<double>(out_.grid.pixels(t)) / static_cast<double>(hidden_.size());
            mse += share * p.mse();
            views += share * p.views;
            met += p.chance;
            least = std::min(least, p.views);
            most = std::max(most, p.views);
        }
        out_.predicted_db = -10 * std::log10(std::max(mse, 1e-12));
        out_.met_share = met / static_cast<double>(out_.tiles.size());
        out_.mean_views = views;
        out_.hybrid.focus.method = FocusMethod::hybrid;
        out_.hybrid.focus.views = most;
        out_.hybrid.focus.geometry = geometry;
        out_.hybrid.focus.largest_coc_px = largest_coc_px(depth_range(frame_.file()), geometry);
        out_.plan = fmt::format(
            "{} to {} views a tile, {:.0f} on the mean, {:.1f} % of the pixels traced again: {:.1f} dB "
            "expected, {:.0f} % of "
            "the tiles at {:.1f} dB or better",
            least, most, views, 100 * out_.hybrid.retraced_share, out_.predicted_db, 100 * out_.met_share,
            settings_.target_db);
        if (!out_.met(settings_.target_db)) {
            out_.hybrid.focus.warnings.push_back(
                {"target", 1 - out_.met_share,
                 fmt::format("{:.1f} dB are expected, and {:.0f} % of the tiles at {:.1f}: {}",
                             out_.predicted_db, 100 * out_.met_share, settings_.target_db, reason())});
        }
    }

    // What keeps the picture from its target.
    [[nodiscard]] std::string reason() const {
        double noise = 0, floor = 0, hidden = 0;
        for (const TilePlan& p : out_.tiles)
            noise += p.noise_mse, floor += p.floor_mse, hidden += p.hidden_mse;
        if (hidden >= noise && hidden >= floor) {
            return settings_.hybrid.scene != nullptr
                       ? "more is hidden from the records than may be traced again (expected a trace with "
                         "--hidden-layers for this lens)"
                       : "the records do not show all that the lens sees (expected --scene, or a trace with "
                         "--hidden-layers for this lens)";
        }
        if (floor >= noise)
            return "the records are too coarse (expected a trace with more --subdivide levels, or render)";
        return fmt::format("even {} views are too few (expected a lower target, or render)", ladder.back());
    }

    FocusFrame& frame_;
    const AutoSettings& settings_;
    const SampleHeader& h_;
    double most_mse_;
    std::vector<double> pilot_noise_;
    std::vector<float> floor_, aligned_, spread_, hidden_;
    std::vector<float> ray_noise_;       ///< of one ray, as so much falls to each of the first
    std::vector<std::uint32_t> pixels_;  ///< to be traced again
    AutoResult out_;
};

}  // namespace

AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings) {
    if (!(settings.target_db >= 10 && settings.target_db <= 80)) {
        fail(ExitCode::wrong_arguments, "--target-db: out of range (got {}; expected 10 to 80)",
             settings.target_db);
    }
    if (settings.hybrid.focus.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments, "--framing: auto keeps the framing of the trace (expected keep)");
    }
    check_has_points(settings.hybrid.focus.impulse);
    if (settings.hybrid.scene != nullptr) check_exposed_alike(*settings.hybrid.scene, frame.file());
    AutoResult out = Planner(frame, settings).run();
    out.hybrid.focus.image.exposure_stops = frame.file().exposure_stops();
    return out;
}

}  // namespace postlens
