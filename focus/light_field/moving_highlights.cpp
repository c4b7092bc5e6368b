#include "focus/light_field/moving_highlights.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>
#include <utility>

namespace postlens {
namespace {

/// Number of instants from which a highlight's speed is computed.
constexpr int looks = 64;
/// A moving highlight is drawn at several instants. Between two of them, it should move by at most step_px
/// (in px), or by step_of_blur times its CoC radius if that is larger.
constexpr double step_px = 0.5, step_of_blur = 0.25;
/// A moving highlight that is drawn at few instants uses one of `turns` sequences of instants, which are
/// shifted relative to each other. For a highlight at the position (x, y), in px, the fractional part of x
/// turn_x + y turn_y chooses the sequence.
constexpr int turns = 16;
constexpr double turn_x = 2.2360679774997896, turn_y = 1.2360679774997896;
/// Largest coordinate and largest CoC radius, in px, with which a moving highlight is drawn. At an instant at
/// which the highlight exceeds either, it is left out.
constexpr double farthest_px = 1e5;

}  // namespace

HighlightMotion::HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, PatchLens lens)
    : moves_(std::move(moves)), map_(std::move(map)), lens_(std::move(lens)) {}

bool HighlightMotion::takes(const Highlight& light, float area_px2) {
    return area_px2 < largest_px2 && light.exceeds(least_radiance);
}

std::shared_ptr<const HighlightMotion::Maps> HighlightMotion::maps(std::uint32_t id, int count) const {
    const std::scoped_lock lock(mutex_);
    std::shared_ptr<const Maps>& known = known_[{id, count}];
    if (!known) {
        Maps made;
        for (int i = 0; i < count; ++i) made.push_back(map_(id, (i + 0.5) / count));
        known = std::make_shared<const Maps>(std::move(made));
    }
    return known;
}

bool HighlightMotion::moved(const Highlight& light, const RasterMap& map, Highlight& out) const {
    const RasterPoint from{static_cast<double>(light.x), static_cast<double>(light.y),
                           static_cast<double>(light.inverse_z)};
    // Applies the motion to three points: the highlight's position, the point one pixel to its right and the
    // point one pixel below it. After the motion, the three points span a parallelogram. Its area is the
    // factor by which the highlight grows, for example because it comes nearer.
    const std::optional<RasterPoint> to = map(from), right = map({from.x + 1, from.y, from.inverse_z}),
                                     below = map({from.x, from.y + 1, from.inverse_z});
    if (!to || !right || !below) return false;
    if (!(std::abs(to->x) < farthest_px && std::abs(to->y) < farthest_px &&
          lens_.radius_px_m * std::abs(to->inverse_z - lens_.inverse_focus_per_m) < farthest_px))
        return false;
    const double larger =
        std::abs((right->x - to->x) * (below->y - to->y) - (right->y - to->y) * (below->x - to->x));
    out = light;
    out.x = static_cast<float>(to->x);
    out.y = static_cast<float>(to->y);
    out.inverse_z = static_cast<float>(to->inverse_z);
    out.w = Mat2::isotropic(out.inverse_z);
    out.area *= static_cast<float>(larger);
    for (float& v : out.rgb) v *= static_cast<float>(larger);
    return true;
}

int HighlightMotion::moments_wanted(const Highlight& light, const SheetKey& key) const {
    if (!moves(key)) return 1;
    double fastest_px = 0;  // largest motion from one instant to the next
    double blur_px = HUGE_VAL;
    Highlight last;
    bool has_last = false;
    const std::shared_ptr<const Maps> ways = maps(key.id, looks);
    for (const RasterMap& map : *ways) {
        Highlight here;
        if (!moved(light, map, here)) {
            has_last = false;
            continue;
        }
        blur_px = std::min(blur_px, lens_.least_blur_px(here.w));
        if (has_last) {
            const double way =
                std::hypot(static_cast<double>(here.x - last.x), static_cast<double>(here.y - last.y));
            const double rim =
                lens_.radius_px_m * std::abs(static_cast<double>(here.inverse_z - last.inverse_z));
            fastest_px = std::max(fastest_px, way + rim);
        }
        last = here;
        has_last = true;
    }
    const double step = std::max(step_px, step_of_blur * (std::isfinite(blur_px) ? blur_px : 0));
    int count = 1;
    while (count < most_moments && count * step < looks * fastest_px) count *= 2;
    return count;
}

std::vector<HighlightMotion::Moment> HighlightMotion::moments(const Highlight& light, const SheetKey& key,
                                                              int count, bool turned) const {
    if (!moves(key)) return {{light, -1, 1}};
    std::vector<Moment> out;
    const int parts = turned ? turns : 1;
    int part = 0;
    if (turned) {
        const double place = turn_x * static_cast<double>(light.x) + turn_y * static_cast<double>(light.y);
        part = std::min(static_cast<int>((place - std::floor(place)) * parts), parts - 1);
    }
    const std::shared_ptr<const Maps> ways = maps(key.id, parts * count);
    for (int i = 0; i < count; ++i) {
        const int at = i * parts + part;
        Moment m{light, (at + 0.5) / (parts * count), 1.0 / count};
        if (moved(light, (*ways)[static_cast<std::size_t>(at)], m.light)) out.push_back(m);
    }
    return out;
}

}  // namespace postlens
