#include "focus/moving_highlights.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>
#include <utility>

namespace postlens {
namespace {

/// Instants that tell how fast it goes.
constexpr int looks = 64;
/// From one moment to the next: px, or of the blur's half width.
constexpr double step_px = 0.5, step_of_blur = 0.25;

}  // namespace

HighlightMotion::HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, const PatchLens& lens)
    : moves_(std::move(moves)), map_(std::move(map)), lens_(lens) {}

bool HighlightMotion::at(const Highlight& light, std::uint32_t id, double u, Highlight& out) const {
    const RasterMap map = map_(id, u);
    const RasterPoint from{static_cast<double>(light.x), static_cast<double>(light.y),
                           static_cast<double>(light.inverse_z)};
    // A pixel to either side: what has come nearer is larger.
    const std::optional<RasterPoint> to = map(from), right = map({from.x + 1, from.y, from.inverse_z}),
                                     below = map({from.x, from.y + 1, from.inverse_z});
    if (!to || !right || !below) return false;
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

std::vector<HighlightMotion::Moment> HighlightMotion::moments(const Highlight& light,
                                                              const SheetKey& key) const {
    if (key.path.bits() != 0 || !moves_(key.id)) return {{light, -1, 1}};
    double fastest_px = 0;  // to the next look
    double blur_px = HUGE_VAL;
    std::optional<Highlight> last;
    for (int i = 0; i <= looks; ++i) {
        Highlight here;
        if (!at(light, key.id, static_cast<double>(i) / looks, here)) {
            last.reset();
            continue;
        }
        blur_px = std::min(blur_px, lens_.least_blur_px(here.w));
        if (last) {
            const double way =
                std::hypot(static_cast<double>(here.x - last->x), static_cast<double>(here.y - last->y));
            const double rim =
                lens_.radius_px_m * std::abs(static_cast<double>(here.inverse_z - last->inverse_z));
            fastest_px = std::max(fastest_px, way + rim);
        }
        last = here;
    }
    const double step = std::max(step_px, step_of_blur * (std::isfinite(blur_px) ? blur_px : 0));
    const int count =
        static_cast<int>(std::clamp(std::ceil(looks * fastest_px / step), 1.0, double{most_moments}));
    std::vector<Moment> out;
    for (int i = 0; i < count; ++i) {
        Moment m{light, (i + 0.5) / count, 1.0 / count};
        if (at(light, key.id, m.u, m.light)) out.push_back(m);
    }
    return out;
}

}  // namespace postlens
