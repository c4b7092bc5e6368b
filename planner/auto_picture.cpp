#include "planner/auto_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "core/error.h"
#include "core/threads.h"
#include "focus/bend_warning.h"
#include "focus/field_focus.h"
#include "planner/local_contrast.h"
#include "planner/record_floor.h"
#include "planner/retrace.h"
#include "planner/tile_choices.h"
#include "records/aperture_file.h"
#include "records/srgb.h"
#include "tracer/point_shading.h"

namespace postlens {
namespace {

constexpr int pilot_views = 8;
constexpr int both_pilots = 2 * pilot_views;
/// Numbers of views that tiles are grouped by: more than needed by a fifth on the mean. The first is both
/// pilots together, to which the others add.
constexpr std::array<int, 14> ladder{both_pilots, 24,  32,  48,  64,  96,   128,
                                     192,         256, 384, 512, 768, 1024, 2048};
/// What is expected of a tile strays by a few dB; so much of what its target allows is aimed at, that nine
/// tiles in ten get there (docs/planner.md).
constexpr double aimed_at = 0.5;
/// What is filled in or misplaced is off by less than filled_in_error and misplaced_error say, which are
/// upper bounds: where they are most of what a tile expects, nine in ten of the calibrating tiles came to
/// 0.38 of it.
constexpr double hidden_seen = 0.5;
/// Of the floor of pixels that are traced again, what is in others: edges run on where no corner sees them.
/// In calibrating tiles that had a third of their pixels or fewer traced again 0.11 to 0.39, mostly 0.2.
constexpr double still_unseen = 0.2;
/// See noise_of_views.
constexpr double noise_exponent = 1.15, two_sets = 0.6;
/// What retraced pixels may add to what a tile may be off by; how many rays tell how many are needed for
/// that.
constexpr double left_by_rays = 0.1;
constexpr int pilot_rays = 16, most_rays = 1024;
/// What a pixel that is traced again costs, in pixels of views. The first rays alone are worth 110 to 420,
/// and where they are noisy there are many more (docs/planner.md).
constexpr double retraced_price = 1280;

/// Of a set of views by itself, for a pilot whose error is 1.
double noise_of_set(int pilot, int views) {
    return views <= pilot ? 1 : two_sets * std::pow(2.0 * pilot / views, noise_exponent);
}

/// Encoded values of a picture, three a pixel.
std::vector<float> encoded(const Image& image) {
    std::vector<float> out(image.rgb.size());
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
        const std::size_t row = 3 * static_cast<std::size_t>(image.width);
        for (std::size_t i = y * row; i < (y + 1) * row; ++i) out[i] = srgb_from_linear(image.rgb[i]);
    });
    return out;
}

class Planner {
  public:
    Planner(FocusFrame& frame, const AutoSettings& settings)
        : frame_(frame),
          settings_(settings),
          h_(frame.file().header()),
          geometry_(focus_geometry(settings.hybrid.focus.lens, settings.hybrid.focus.focus_distance_m,
                                   Framing::keep, {h_.film_distance_mm, h_.pixel_pitch_mm})),
          aperture_(read_aperture(settings.hybrid.focus.impulse)),
          most_mse_(std::pow(10.0, -settings.target_db / 10)),
          aim_(aimed_at * most_mse_) {
        out_.grid = {h_.width, h_.height};
        out_.tiles.resize(out_.grid.count());
    }

    AutoResult run() {
        FieldFocusSettings by_field{geometry_, aperture_, {0, h_.width, 0, h_.height}, pilot_views, {}, {}};
        const HybridSettings& s = settings_.hybrid;
        if (s.motion != nullptr && s.shutter)
            by_field.shutter = {s.motion, s.shutter->open_s, s.shutter->close_s, s.curve};
        MisplacedLight misplaced(h_, geometry_);
        RecordFloor floor(h_, geometry_);
        by_field.also.rows = [&](const RecordBand& band, int y_begin, int y_end) {
            misplaced.add(band, y_begin, y_end);
        };
        by_field.also.leaves = floor.adds();
        const FieldFocuser focuser(frame_, by_field);
        aligned_ = floor.aligned();
        floor_ = std::move(floor).picture();
        pilot(focuser, misplaced.picture());
        choose();
        draw(focuser);
        trace_again();
        sum_up();
        return std::move(out_);
    }

  private:
    void pilot(const FieldFocuser& focuser, const std::vector<float>& misplaced) {
        const std::array<FieldViews, 2> sets{{{pilot_views, 0, {}, {}, 0}, {pilot_views, 1, {}, {}, 1}}};
        std::vector<FieldFocus> drawn = focuser.draw(sets);
        FieldFocus& a = drawn[0];
        const FieldFocus& b = drawn[1];
        const std::vector<float> ea = encoded(a.image), eb = encoded(b.image);
        const TileGrid& grid = out_.grid;
        // Half the mean squared difference of two sets is the error of one.
        const std::vector<double> noise = grid.means([&](std::size_t k) {
            double sum = 0;
            for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
                const double d = static_cast<double>(ea[c]) - static_cast<double>(eb[c]);
                sum += d * d / 6;
            }
            return sum;
        });
        const std::vector<double> floor =
            grid.means([&](std::size_t k) { return static_cast<double>(floor_[k]); });
        const std::vector<float> contrast = local_contrast(a.image);
        hidden_.resize(a.unknown.size());
        for (std::size_t k = 0; k < hidden_.size(); ++k) {
            const double unknown = (static_cast<double>(std::max(a.unknown[k], a.unknown_below[k])) +
                                    static_cast<double>(std::max(b.unknown[k], b.unknown_below[k]))) /
                                   2;
            const double lost = misplaced.empty() ? 0 : static_cast<double>(srgb_from_linear(misplaced[k]));
            hidden_[k] =
                static_cast<float>(hidden_seen * (filled_in_error(unknown, static_cast<double>(contrast[k])) +
                                                  misplaced_error(lost)));
        }
        const std::vector<double> hidden =
            grid.means([&](std::size_t k) { return static_cast<double>(hidden_[k]); });
        for (std::size_t t = 0; t < grid.count(); ++t) {
            pilot_noise_.push_back(noise[t]);
            out_.tiles[t].floor_mse = floor_unseen * floor[t];
            out_.tiles[t].hidden_mse = hidden[t];
        }
        for (std::size_t i = 0; i < a.image.rgb.size(); ++i)
            a.image.rgb[i] = (a.image.rgb[i] + b.image.rgb[i]) / 2;
        out_.hybrid.focus.image = std::move(a.image);
        out_.hybrid.what.assign(hidden_.size(), 0);
    }

    /// Of each tile the cheapest number of views, and of its pixels those that are then to be traced again.
    void choose() {
        const std::size_t tiles = out_.tiles.size();
        std::vector<std::vector<TileChoice>> choices(tiles);
        parallel_for(tiles, [&](std::size_t t) { choices[t] = choices_of(t); });
        const auto most =
            static_cast<std::size_t>(settings_.hybrid.most_retraced * static_cast<double>(hidden_.size()));
        const std::vector<TileChoice> chosen = cheapest_choices(choices, out_.grid, retraced_price, most);
        std::vector<std::vector<std::uint32_t>> pixels(tiles);
        parallel_for(tiles, [&](std::size_t t) {
            out_.tiles[t].views = chosen[t].views;
            out_.tiles[t].noise_mse = chosen[t].noise_mse;
            if (chosen[t].retraced == 0) return;
            pixels[t] = rest_of(t).pixels;
            pixels[t].resize(chosen[t].retraced);
        });
        for (const auto& some : pixels) pixels_.insert(pixels_.end(), some.begin(), some.end());
        std::sort(pixels_.begin(), pixels_.end(), [&](std::uint32_t a, std::uint32_t b) {
            const double p = at_worst(a), q = at_worst(b);
            return p != q ? p > q : a < b;
        });
        out_.hybrid.wanted_share = static_cast<double>(pixels_.size()) / static_cast<double>(hidden_.size());
    }

    /// Those that bring a tile to its aim, or as near as can be; by growing number of views.
    [[nodiscard]] std::vector<TileChoice> choices_of(std::size_t t) const {
        const TileRest rest = rest_of(t);
        const double unseen = still_unseen * out_.tiles[t].floor_mse, all = rest.mean[0] + unseen;
        // Where the rest alone is too much, views that add a third of it are as good as any; unless what
        // keeps the tile from its target can be traced again.
        const bool has_scene = settings_.hybrid.scene != nullptr;
        const double room = std::max(aim_ - all, (has_scene ? aim_ : all) / 3);
        std::vector<TileChoice> out;
        TileChoice last;
        for (const int views : ladder) {
            const double noise = noise_of_views(pilot_noise_[t], pilot_views, views);
            const auto needed = rest.needed(aim_ - noise - unseen, most_mse_ - noise - unseen);
            last = {views, noise, needed.value_or(rest.nearly_all())};
            // Without the scene there is nothing to choose: nothing can be traced again.
            if (has_scene && needed) out.push_back(last);
            if (noise <= room) break;
        }
        if (out.empty()) out.push_back(last);
        return out;
    }

    [[nodiscard]] TileRest rest_of(std::size_t tile) const {
        return {out_.grid, tile, [this](std::uint32_t k) { return error(k); },
                [this](std::uint32_t k) { return at_worst(k); }};
    }

    /// What tracing a pixel again makes good, beside the noise of views; and should its edges be worse than
    /// the mean.
    [[nodiscard]] double error(std::uint32_t k) const {
        return static_cast<double>(hidden_[k]) + removed_floor(k);
    }
    [[nodiscard]] double removed_floor(std::uint32_t k) const {
        return (1 - still_unseen) * floor_unseen * static_cast<double>(floor_[k]);
    }
    [[nodiscard]] double at_worst(std::uint32_t k) const {
        return error(k) + floor_unseen * (aligned_nine_in_ten - 1) * static_cast<double>(aligned_[k]);
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
            sets.push_back({views - both_pilots, 2, wanted, {}, 0});
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

    void trace_again() {
        HybridResult& hybrid = out_.hybrid;
        const HybridSettings& s = settings_.hybrid;
        std::vector<std::uint32_t>& pixels = pixels_;
        if (s.scene == nullptr || pixels.empty()) return;
        limit_retraced(s.most_retraced, pixels, hybrid);
        trace_pixels(pixels);
        for (std::size_t k = 0; k < hybrid.what.size(); ++k) {
            if (hybrid.what[k] != 2) continue;
            TilePlan& p = out_.tiles[tile_of(k)];
            const double part = 1.0 / out_.grid.pixels(tile_of(k));
            p.retraced += part;
            p.floor_mse = std::max(0.0, p.floor_mse - part * removed_floor(static_cast<std::uint32_t>(k)));
            p.hidden_mse = std::max(0.0, p.hidden_mse - part * static_cast<double>(hidden_[k]));
        }
    }

    /// Two sets of rays, whose difference tells their noise; more where that is too much of what a tile may
    /// be off by. By tiles, as a pixel where both sets miss a lamp does not know.
    void trace_pixels(const std::vector<std::uint32_t>& pixels) {
        const HybridSettings& s = settings_.hybrid;
        RenderSettings rays = retrace_settings(h_, s, checked_camera(h_, *s.scene), aperture_);
        rays.spp = pilot_rays;
        rays.seed = 1;
        retrace(*s.scene, rays, pixels, out_.hybrid);
        Image& picture = out_.hybrid.focus.image;
        const Image first = picture;
        rays.seed = 2;
        retrace(*s.scene, rays, pixels, out_.hybrid);
        std::vector<double> noise(out_.tiles.size());
        for (const std::uint32_t k : pixels) {
            for (std::size_t c = 3 * std::size_t{k}; c < 3 * std::size_t{k} + 3; ++c) {
                const double d = static_cast<double>(srgb_from_linear(first.rgb[c])) -
                                 static_cast<double>(srgb_from_linear(picture.rgb[c]));
                noise[tile_of(k)] += d * d / 12 / out_.grid.pixels(tile_of(k));
                picture.rgb[c] = (first.rgb[c] + picture.rgb[c]) / 2;
            }
        }
        std::map<int, std::vector<std::uint32_t>> by_rays;
        for (const std::uint32_t k : pixels) {
            const double factor = noise[tile_of(k)] / (left_by_rays * most_mse_);
            int spp = pilot_rays;
            while (spp < most_rays && spp < 2 * pilot_rays * (factor - 1)) spp *= 2;
            if (factor > 1) by_rays[spp].push_back(k);
        }
        const Image both = picture;
        rays.seed = 3;
        for (const auto& [spp, some] : by_rays) {
            rays.spp = spp;
            retrace(*s.scene, rays, some, out_.hybrid);
            const float share = static_cast<float>(spp) / static_cast<float>(spp + 2 * pilot_rays);
            for (const std::uint32_t k : some) {
                for (std::size_t c = 3 * std::size_t{k}; c < 3 * std::size_t{k} + 3; ++c)
                    picture.rgb[c] = both.rgb[c] + share * (picture.rgb[c] - both.rgb[c]);
            }
        }
        out_.hybrid.retraced_share =
            static_cast<double>(pixels.size()) / static_cast<double>(out_.hybrid.what.size());
    }

    [[nodiscard]] std::size_t tile_of(std::size_t pixel) const {
        const auto width = static_cast<std::size_t>(h_.width);
        return out_.grid.at(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
    }

    void sum_up() {
        double mse = 0, views = 0, met = 0;
        int least = ladder.back(), most = ladder.front();
        for (std::size_t t = 0; t < out_.tiles.size(); ++t) {
            const TilePlan& p = out_.tiles[t];
            const double share =
                static_cast<double>(out_.grid.pixels(t)) / static_cast<double>(hidden_.size());
            mse += share * p.mse();
            views += share * p.views;
            met += p.mse() <= most_mse_ ? 1 : 0;
            least = std::min(least, p.views);
            most = std::max(most, p.views);
        }
        out_.predicted_db = -10 * std::log10(std::max(mse, 1e-12));
        out_.met_share = met / static_cast<double>(out_.tiles.size());
        out_.mean_views = views;
        out_.hybrid.focus.method = FocusMethod::hybrid;
        out_.hybrid.focus.views = most;
        out_.hybrid.focus.geometry = geometry_;
        out_.hybrid.focus.largest_coc_px = largest_coc_px(depth_range(frame_.file()), geometry_);
        out_.plan = fmt::format(
            "{} to {} views a tile, {:.0f} on the mean, {:.1f} % of the pixels traced again: {:.1f} dB "
            "expected, {:.0f} % of "
            "the tiles at {:.1f} dB or better",
            least, most, views, 100 * out_.hybrid.retraced_share, out_.predicted_db, 100 * out_.met_share,
            settings_.target_db);
        if (settings_.hybrid.scene != nullptr) {
            for (const ShadingNote& n : point_shading_notes(*settings_.hybrid.scene)) {
                out_.hybrid.focus.warnings.push_back(
                    {n.code, 1, fmt::format("{}; what is expected leaves that out", n.text)});
            }
        }
        if (!out_.met(settings_.target_db)) {
            out_.hybrid.focus.warnings.push_back(
                {"target", 1 - out_.met_share,
                 fmt::format("{:.1f} dB are expected instead of {:.1f}: {}", out_.predicted_db,
                             settings_.target_db, reason())});
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
    FocusGeometry geometry_;
    Aperture aperture_;
    double most_mse_, aim_;
    std::vector<double> pilot_noise_;
    std::vector<float> floor_, aligned_, hidden_;
    std::vector<std::uint32_t> pixels_;  ///< to be traced again, the worst first
    AutoResult out_;
};

}  // namespace

double noise_of_views(double pilot_mse, int pilot, int views) {
    if (views <= pilot) return pilot_mse;
    // Two sets are not quite independent: both are evenly spread over the lens.
    if (views <= 2 * pilot) return two_sets * pilot_mse;
    return pilot_mse / (1 / two_sets + 1 / noise_of_set(pilot, views - 2 * pilot));
}

AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings) {
    if (!(settings.target_db >= 10 && settings.target_db <= 80)) {
        fail(ExitCode::wrong_arguments, "--target-db: out of range (got {}; expected 10 to 80)",
             settings.target_db);
    }
    if (settings.hybrid.focus.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments, "--framing: auto keeps the framing of the trace (expected keep)");
    }
    check_has_points(settings.hybrid.focus.impulse);
    return Planner(frame, settings).run();
}

}  // namespace postlens
