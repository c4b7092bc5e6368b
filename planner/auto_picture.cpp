#include "planner/auto_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/threads.h"
#include "focus/bend_warning.h"
#include "focus/field_focus.h"
#include "planner/local_contrast.h"
#include "planner/record_floor.h"
#include "planner/retrace.h"
#include "records/aperture_file.h"
#include "records/srgb.h"
#include "tracer/point_shading.h"

namespace postlens {
namespace {

constexpr int pilot_views = 8;
/// Numbers of views that tiles are grouped by: a step of two costs a third more than needed on the mean, and
/// each group costs a pass over the surfaces. The first is both pilots together.
constexpr std::array<int, 8> ladder{2 * pilot_views, 32, 64, 128, 256, 512, 1024, 2048};
/// What is expected of a tile strays by a few dB; so much of what its target allows is aimed at, that nine
/// tiles in ten get there (docs/planner.md).
constexpr double aimed_at = 0.6;
/// What is filled in or misplaced is off by less than filled_in_error and misplaced_error say, which are
/// upper bounds: where they are most of what a tile expects, nine in ten of the calibrating tiles came to
/// 0.38 of it.
constexpr double hidden_seen = 0.5;
/// See noise_of_views.
constexpr double noise_exponent = 1.15, both_pilots = 0.6;

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
        by_field.also = [&](const RecordBand& band, int y_begin, int y_end) {
            misplaced.add(band, y_begin, y_end);
            floor.add(band, y_begin, y_end);
        };
        const FieldFocuser focuser(frame_, by_field);
        aligned_ = floor.aligned();
        floor_ = std::move(floor).picture();
        pilot(focuser, misplaced.picture());
        choose_views();
        draw(focuser);
        trace_again();
        sum_up();
        return std::move(out_);
    }

  private:
    void pilot(const FieldFocuser& focuser, const std::vector<float>& misplaced) {
        FieldFocus a = focuser.draw({pilot_views, 0, {}, {}});
        const FieldFocus b = focuser.draw({pilot_views, 1, {}, {}});
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

    void choose_views() {
        for (std::size_t t = 0; t < out_.tiles.size(); ++t) {
            TilePlan& p = out_.tiles[t];
            const double rest = p.floor_mse + p.hidden_mse;
            // Where the rest alone is too much, views that add a third of it are as good as any; unless what
            // keeps the tile from its target can be traced again.
            const double room = settings_.hybrid.scene != nullptr ? std::max(aim_ - rest, aim_ / 3)
                                                                  : std::max(aim_ - rest, rest / 3);
            p.views = ladder.back();
            for (const int m : ladder) {
                p.noise_mse = noise_of_views(pilot_noise_[t], pilot_views, m);
                if (p.noise_mse <= room) {
                    p.views = m;
                    break;
                }
            }
        }
    }

    void draw(const FieldFocuser& focuser) {
        std::map<int, std::size_t> groups;
        for (const TilePlan& p : out_.tiles) ++groups[p.views];
        Image& picture = out_.hybrid.focus.image;
        for (const auto& [views, tiles] : groups) {
            if (views == ladder.front()) continue;  // the pilots' mean is there already
            const auto wanted = [&, views = views](int x, int y) {
                return out_.tiles[out_.grid.at(x, y)].views == views;
            };
            // Another set than the pilots', which chose the tile: what happened to be small there must not be
            // small here again.
            const FieldFocus f =
                focuser.draw({views, 2, [&](int x, int y, int, int) { return wanted(x, y); }, {}});
            for (int y = 0; y < h_.height; ++y) {
                for (int x = 0; x < h_.width; ++x) {
                    if (wanted(x, y)) std::copy_n(f.image.pixel(x, y), 3, picture.pixel(x, y));
                }
            }
        }
    }

    void trace_again() {
        HybridResult& hybrid = out_.hybrid;
        const HybridSettings& s = settings_.hybrid;
        // What a tile has above its aim; and above its target, should its edges be worse than the mean.
        const auto bad_luck = [&](std::size_t k) {
            return floor_unseen * (aligned_nine_in_ten - 1) * static_cast<double>(aligned_[k]);
        };
        std::vector<double> left(out_.tiles.size()), unlucky = out_.grid.means(bad_luck);
        for (std::size_t t = 0; t < left.size(); ++t) {
            left[t] = out_.tiles[t].mse() - aim_;
            unlucky[t] += out_.tiles[t].mse() - most_mse_;
        }
        std::vector<std::uint32_t> order(hidden_.size()), pixels;
        std::iota(order.begin(), order.end(), 0U);
        const auto error = [&](std::uint32_t k) {
            return static_cast<double>(hidden_[k]) + floor_unseen * static_cast<double>(floor_[k]);
        };
        const auto at_worst = [&](std::uint32_t k) { return error(k) + bad_luck(k); };
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return at_worst(a) > at_worst(b); });
        for (const std::uint32_t k : order) {
            const auto x = static_cast<int>(k % static_cast<std::uint32_t>(h_.width)),
                       y = static_cast<int>(k / static_cast<std::uint32_t>(h_.width));
            const std::size_t t = out_.grid.at(x, y);
            if (left[t] <= 0 && unlucky[t] <= 0) continue;
            left[t] -= error(k) / out_.grid.pixels(t);
            unlucky[t] -= at_worst(k) / out_.grid.pixels(t);
            pixels.push_back(k);
        }
        hybrid.wanted_share = static_cast<double>(pixels.size()) / static_cast<double>(order.size());
        if (s.scene == nullptr || pixels.empty()) return;
        HybridSettings with_rays = s;
        // A pixel across an edge, the worst there is, has a variance of a quarter; Sobol points of n rays
        // leave about a twentieth of it over n.
        const double rays = 0.25 / (20 * most_mse_);
        with_rays.retrace_spp =
            static_cast<int>(std::clamp(std::exp2(std::ceil(std::log2(rays * 4))), 64.0, 1024.0));
        retrace(*s.scene, retrace_settings(h_, with_rays, checked_camera(h_, *s.scene), aperture_),
                s.most_retraced, pixels, hybrid);
        for (std::size_t k = 0; k < hybrid.what.size(); ++k) {
            if (hybrid.what[k] != 2) continue;
            const auto x = static_cast<int>(k % static_cast<std::size_t>(h_.width)),
                       y = static_cast<int>(k / static_cast<std::size_t>(h_.width));
            TilePlan& p = out_.tiles[out_.grid.at(x, y)];
            const double share = 1.0 / out_.grid.pixels(out_.grid.at(x, y));
            p.retraced += share;
            p.floor_mse = std::max(0.0, p.floor_mse - share * floor_unseen * static_cast<double>(floor_[k]));
            p.hidden_mse = std::max(0.0, p.hidden_mse - share * static_cast<double>(hidden_[k]));
        }
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
    AutoResult out_;
};

}  // namespace

double noise_of_views(double pilot_mse, int pilot, int views) {
    if (views <= pilot) return pilot_mse;
    // Two sets are not quite independent: both are evenly spread over the lens.
    if (views <= 2 * pilot) return both_pilots * pilot_mse;
    return both_pilots * pilot_mse * std::pow(2.0 * pilot / views, noise_exponent);
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
