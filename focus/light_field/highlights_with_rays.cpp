#include "focus/light_field/highlights_with_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "focus/light_field/measured_edges.h"

namespace postlens {
namespace {

/// Identifies a surface by properties that a ray can determine: path, id of the last reflecting or
/// transmitting object, id of the surface, and column and row of its square of the raster.
using SurfaceSeen = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, int, int>;

SurfaceSeen surface_seen(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at,
                         bool moves) {
    if (path.bits() != 0 || moves) return {path.bits(), parent_id, id, 0, 0};
    const auto square = [](double px) {
        return static_cast<int>(std::floor(std::clamp(px, -1e8, 1e8) / SheetMesh::square_px));
    };
    return {0, parent_id, id, square(at.x), square(at.y)};
}

/// Whether the records contain a highlight completely. A part that a nearer surface hides must be recorded.
/// In mirrors and glass, nothing may be hidden, and W must be linear over the lens.
bool is_complete(const Highlight& light, const SheetKey& key, const PatchLens& lens) {
    if (key.hidden) return false;
    if (key.path.bits() == 0) return light.hides != Hides::unknown;
    return light.hides == Hides::nothing && lens.bend_px_m2 * static_cast<double>(light.bend) <= most_bend_px;
}

}  // namespace

LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens, bool moves,
                             HighlightRule& rule) {
    const auto of_light = [moves](const Highlight& light, const SheetKey& key) {
        return surface_seen(key.path, key.parent_id, key.id, {light.x, light.y}, moves);
    };
    std::map<SurfaceSeen, bool> taken;
    for (const SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) {
        const std::vector<BrightSheet> bright = bright_sheets(*mesh);
        for (const Highlight& light : mesh->bright) {
            const SheetKey& key = mesh->sheets[light.sheet].key;
            bool& all = taken.try_emplace(of_light(light, key), true).first->second;
            all = all && rays.steady(key.path, key.id) && is_complete(light, key, lens) &&
                  rule.takes(light, key, bright[light.sheet]);
        }
    }
    std::erase_if(taken, [](const auto& t) { return !t.second; });
    rule.takes = [taken, of_light, takes = rule.takes](const Highlight& light, const SheetKey& key,
                                                       const BrightSheet& sheet) {
        return taken.contains(of_light(light, key)) && takes(light, key, sheet);
    };
    take_highlights(sheets, rule);
    LightElsewhere less{rule.above, nullptr};
    if (taken.empty()) return less;
    less.of = [taken = std::move(taken), moves](NodePath path, std::uint32_t parent_id, std::uint32_t id,
                                                const glm::dvec2& at) {
        return taken.contains(surface_seen(path, parent_id, id, at, moves));
    };
    if (!moves) measure_edges(sheets.primary, rays, less);
    return less;
}

}  // namespace postlens
