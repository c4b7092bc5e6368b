#include "planner/views/halved_views.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/threads.h"
#include "focus/responses/depth_levels.h"
#include "pictures/crop.h"
#include "planner/views/picture_request.h"
#include "tracer/shading/averaged_shading.h"

namespace postlens {
namespace {

static_assert(TileGrid::edge == SeenTile::edge, "LeftToRays is chosen per tile of the grid");

/// Number of sets of lens points that the squares of an image use. The square in column c and row r uses set
/// (c + scrambles_down * r) % scrambles. So squares with the same set, and therefore equal noise, are far
/// apart.
constexpr int scrambles = 61, scrambles_down = 23;

template <typename T>
void mix(const std::vector<T>& from, std::vector<T>& to, std::size_t begin, std::size_t count, float share) {
    if (from.empty()) return;
    for (std::size_t i = begin; i < begin + count; ++i)
        to[i] = share < 1 ? to[i] + share * (from[i] - to[i]) : from[i];
}

void mix_pixel(const FieldFocus& from, std::size_t k, float share, FieldFocus& to) {
    mix(from.image.rgb, to.image.rgb, 3 * k, 3, share);
    mix(from.unknown, to.unknown, k, 1, share);
    mix(from.unknown_below, to.unknown_below, k, 1, share);
    mix(from.traced, to.traced, k, 1, share);
    mix(from.light_square, to.light_square, k, 1, share);
}

}  // namespace

HalvedViews::HalvedViews(FocusFrame& frame, const HybridSettings& settings, int first_set)
    : by_field_(field_settings(frame.file().header(), settings)),
      grid_{by_field_.window.width(), by_field_.window.height()},
      first_set_(first_set),
      checked_(settings.checked),
      checked_pixels_(grid_.width, grid_.height,
                      settings.scene != nullptr && averaged_shading(*settings.scene).any()) {
    const SampleHeader& h = frame.file().header();
    if (settings.scene != nullptr) {
        setup_ =
            std::make_unique<RenderSetup>(*settings.scene, ray_settings(h, settings, by_field_.aperture));
        rays_ = std::make_unique<SceneRays>(*setup_, DistributedSettings{h.max_depth, h.min_contribution},
                                            most_lens_views);
        by_field_.rays = rays_.get();
    }
    by_field_.piece_px = piece_px(grid_.width, grid_.height);
    focuser_ = std::make_unique<FieldFocuser>(frame, by_field_);
    views_.assign(grid_.count(), 0);
    left_.assign(grid_.count(), LeftToRays::unsure);
}

void HalvedViews::draw(const std::vector<int>& views) {
    const auto scramble_of = [piece = by_field_.piece_px](int x, int y) {
        return (x / piece + scrambles_down * (y / piece)) % scrambles;
    };
    std::vector<FieldViews> sets;
    for (std::size_t half = 0; half < 2; ++half) {
        // Finds the lens points for which views must be drawn. A piece (square) of the image needs the points
        // `first` to `end` - 1 of its set of lens points. `spans` maps each such range to the sets of all
        // pieces that need it, because these are drawn together.
        std::map<std::pair<int, int>, std::set<int>> spans;
        for (int y = 0; y < grid_.height; y += by_field_.piece_px) {
            for (int x = 0; x < grid_.width; x += by_field_.piece_px) {
                const std::size_t t = grid_.at(x, y);
                const std::pair span{of_half(views_[t], half), of_half(views[t], half)};
                if (span.first < span.second) spans[span].insert(scramble_of(x, y));
            }
        }
        for (const auto& [span, used] : spans) {
            const auto [first, end] = span;
            for (const int scramble : used) {
                FieldViews set{.count = end - first,
                               .set = first_set_ + 2 * scramble + static_cast<int>(half),
                               .first = first,
                               .picture = half};
                set.wanted = [&, this, first = first, end = end, half, scramble, scramble_of](int x, int y,
                                                                                              int, int) {
                    const std::size_t t = grid_.at(x, y);
                    return of_half(views_[t], half) == first && of_half(views[t], half) == end &&
                           scramble_of(x, y) == scramble;
                };
                if (rays_) {
                    set.left_to_rays = [this](int x, int y) { return left_[grid_.at(x, y)]; };
                    set.checked = checked_;
                    if (!checked_) {
                        set.checked = [half, first = first, count = end - first, pixels = checked_pixels_](
                                          int x, int y, std::vector<std::uint32_t>& some) {
                            pixels.views(x, y, static_cast<int>(half), first, count, some);
                        };
                        set.aimed = [views = end, pixels = checked_pixels_](int x, int y) {
                            return pixels.aimed(x, y, views);
                        };
                    }
                }
                sets.push_back(std::move(set));
            }
        }
    }
    if (sets.empty()) return;
    spare_ = focuser_->draw(sets, std::move(spare_));
    for (std::size_t half = 0; half < spare_.size(); ++half) take(spare_[half], half, views);
    for (std::size_t t = 0; t < views.size(); ++t) views_[t] = std::max(views_[t], views[t]);
}

void HalvedViews::take(FieldFocus& drawn, std::size_t half, const std::vector<int>& views) {
    FieldFocus& to = halves_[half];
    if (to.image.rgb.empty()) {
        to = std::exchange(drawn, {});
        return;
    }
    parallel_for(static_cast<std::size_t>(grid_.height), [&](std::size_t row) {
        std::size_t k = row * static_cast<std::size_t>(grid_.width);
        for (int x = 0; x < grid_.width; ++x, ++k) {
            const std::size_t t = grid_.at(x, static_cast<int>(row));
            const int before = of_half(views_[t], half), after = of_half(views[t], half);
            if (before >= after) continue;
            const double share = static_cast<double>(after - before) / after;
            mix_pixel(drawn, k, static_cast<float>(share), to);
            if (to.checks.empty()) continue;
            PixelCheck& check = to.checks[k];
            const PixelCheck& more = drawn.checks[k];
            const std::uint32_t both = check.views + more.views;
            for (std::size_t c = 0; c < 3; ++c)
                check.sum[c] =
                    static_cast<float>(both * (check.mean(c) + share * (more.mean(c) - check.mean(c))));
            check.views = both;
            check.rays += more.rays;
            if (to.highlight_checks.empty()) continue;
            HighlightCheck& lights = to.highlight_checks[k];
            const HighlightCheck& more_lights = drawn.highlight_checks[k];
            if (before == 0) {  // drawn anew, with the same lines
                check.rays += lights.aimed;
                lights.aimed = 0;
                lights.aimed_sum = {};
            }
            for (std::size_t c = 0; c < 3; ++c) {
                lights.light[c] += static_cast<float>(share) * (more_lights.light[c] - lights.light[c]);
                lights.aimed_sum[c] += more_lights.aimed_sum[c];
            }
            lights.aimed += more_lights.aimed;
            lights.aimed_share = more_lights.aimed_share;
        }
    });
}

bool HalvedViews::leave_to_rays(const std::vector<std::uint8_t>& tiles, LeftToRays what) {
    const std::vector<int> wanted = views_;
    bool any = false;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        if (tiles[t] == 0 || left_[t] >= what) continue;
        any = true;
        left_[t] = what;
        views_[t] = 0;
    }
    if (any) draw(wanted);
    return any;
}

FieldFocus HalvedViews::whole() && {
    FieldFocus all = std::move(halves_[0]);
    const FieldFocus& other = halves_[1];
    if (other.image.rgb.empty()) return all;
    parallel_for(static_cast<std::size_t>(grid_.height), [&](std::size_t row) {
        std::size_t k = row * static_cast<std::size_t>(grid_.width);
        for (int x = 0; x < grid_.width; ++x, ++k) {
            const int views = views_[grid_.at(x, static_cast<int>(row))];
            if (views < 2) continue;
            mix_pixel(other, k, static_cast<float>(static_cast<double>(of_half(views, 1)) / views), all);
            if (all.checks.empty()) continue;
            for (std::size_t c = 0; c < 3; ++c) all.checks[k].sum[c] += other.checks[k].sum[c];
            all.checks[k].views += other.checks[k].views;
            all.checks[k].rays += other.checks[k].rays;
        }
    });
    return all;
}

HybridResult finished(FocusFrame& frame, HalvedViews&& views, const std::optional<Crop>& crop) {
    const SampleFileReader& file = frame.file();
    HybridResult out;
    out.rays = views.rays();
    out.focus.geometry = views.geometry();
    out.focus.largest_coc_px = largest_coc_px(depth_range(file), views.geometry());
    FieldFocus all = std::move(views).whole();
    out.focus.image = std::move(all.image);
    out.focus.image.exposure_stops = file.exposure_stops();
    out.what.assign(all.unknown.size(), 0);
    out.traced = std::move(all.traced);
    out.checks = std::move(all.checks);
    if (out.traced.empty()) return out;
    for (std::size_t k = 0; k < out.what.size(); ++k) {
        if (out.traced[k] > 0.5F) out.what[k] = 2;
    }
    out.retraced_share = mean_of(out.traced, file.header().width, crop);
    return out;
}

}  // namespace postlens
