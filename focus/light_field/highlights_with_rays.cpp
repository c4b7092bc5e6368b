#include "focus/light_field/highlights_with_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/sample_hash.h"
#include "focus/light_field/measured_edges.h"

namespace postlens {
namespace {

/// Identifies the surface that a ray hits, by five values:
/// - the sequence of reflections and transmissions before the hit
/// - the number of the mirror or glass object that caused the last of them
/// - the number of the object that is hit
/// - column and row of the square of 16 x 16 px in which the surface is seen; 0 after a reflection or
///   transmission, and if anything moves
using SurfaceSeen = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, int, int>;

SurfaceSeen surface_seen(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at,
                         bool moves) {
    if (path.bits() != 0 || moves) return {path.bits(), parent_id, id, 0, 0};
    const auto square = [](double px) {
        return static_cast<int>(std::floor(std::clamp(px, -1e8, 1e8) / SheetMesh::square_px));
    };
    return {0, parent_id, id, square(at.x), square(at.y)};
}

/// The bright light of one surface (SurfaceSeen).
struct BrightLight {
    bool is_taken = true;
    float area_px2 = 0;
    double blur_px = 0;  ///< largest radius of its circles of confusion
};

/// Limit for spreading bright light by blur kernels. The mean of images from many lens points would show a
/// small light as separate copies. But if the light fills at least this fraction of the area over which it is
/// blurred, the copies overlap and are invisible.
constexpr double filling = 0.5;

/// Returns whether bright light fills most of the area over which a directly visible surface is blurred.
/// `surface` lies in a square of 16 x 16 px of the image. The blurred area consists of this square and of all
/// squares within the blur radius around it. The bright areas of the same object in them are added up.
bool fills_its_blur(const std::map<SurfaceSeen, BrightLight>& all, const SurfaceSeen& surface) {
    const auto [path, parent_id, id, x, y] = surface;
    constexpr double most_px = 1e5;  // wider than any image
    const double blur_px = std::min(all.at(surface).blur_px, most_px);
    const int reach = static_cast<int>(std::ceil(blur_px / SheetMesh::square_px));
    double area_px2 = 0;
    for (int column = x - reach; column <= x + reach; ++column) {
        const auto end = all.upper_bound({path, parent_id, id, column, y + reach});
        for (auto square = all.lower_bound({path, parent_id, id, column, y - reach}); square != end; ++square)
            area_px2 += static_cast<double>(square->second.area_px2);
    }
    return area_px2 >= filling * std::pow((2 * reach + 1) * SheetMesh::square_px, 2);
}

/// Returns whether the sample file is sure to contain all of a highlight that any point of the lens can see.
/// The file may lack parts of a surface that a nearer one hides from the pinhole, so a highlight on a hidden
/// surface never counts as complete.
bool is_complete(const Highlight& light, const SheetKey& key, const PatchLens& lens) {
    if (key.hidden) return false;
    if (key.path.bits() == 0) return light.hides != Hides::unknown;
    return light.hides == Hides::nothing && lens.bend_px_m2 * static_cast<double>(light.bend) <= most_bend_px;
}

/// Returns whether a bright surface is so steep that some lens points see it edge-on or from behind. The file
/// then does not describe its light well, because it was recorded from the lens's centre.
///
/// The slope is measured with rays to random points of `lights`, the highlights of the object `id`.
bool is_seen_from_its_edge(std::span<const Highlight* const> lights, std::uint32_t id, const SightRays& rays,
                           const PatchLens& lens) {
    constexpr std::size_t probes = 64;
    std::vector<SightLine> lines(probes);
    for (std::uint32_t i = 0; i < probes; ++i) {
        const Highlight& light = *lights[i * lights.size() / probes];
        const auto aside = [&](std::uint32_t axis) {
            return std::sqrt(light.area) * (unit_float(random_word(id, 2 * i + axis)) - 0.5F);
        };
        lines[i] = line_through({light.x + aside(0), light.y + aside(1)});
    }
    std::vector<glm::dvec3> inverse_z(probes);
    rays.inverse_depths(lines, id, inverse_z);
    std::size_t met = 0, steep = 0;
    for (const glm::dvec3& d : inverse_z) {
        if (d.x == 0) continue;
        ++met;
        steep += lens.radius_px_m * std::hypot(d.y, d.z) >= 1 ? 1 : 0;
    }
    // At least half of the points must be steep, because even a round surface has some near its outline.
    return met > 0 && 2 * steep >= met;
}

}  // namespace

LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens, bool moves,
                             HighlightRule& rule) {
    const auto of_light = [moves](const Highlight& light, const SheetKey& key) {
        return surface_seen(key.path, key.parent_id, key.id, {light.x, light.y}, moves);
    };
    std::map<SurfaceSeen, BrightLight> found;
    std::map<SurfaceSeen, std::vector<const Highlight*>> direct;
    for (const SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) {
        const std::vector<BrightSheet> bright = bright_sheets(*mesh);
        for (const Highlight& light : mesh->bright) {
            const SheetKey& key = mesh->sheets[light.sheet].key;
            const SurfaceSeen surface = of_light(light, key);
            BrightLight& all = found[surface];
            all.area_px2 += light.area;
            all.blur_px = std::max(all.blur_px, lens.least_blur_px(light.w));
            all.is_taken = all.is_taken && rays.steady(key.path, key.id) && is_complete(light, key, lens) &&
                           rule.takes(light, key, bright[light.sheet]);
            if (all.is_taken && !moves && key.path.bits() == 0) direct[surface].push_back(&light);
        }
    }
    std::set<SurfaceSeen> taken;
    for (const auto& [surface, light] : found) {
        if (!light.is_taken) continue;
        const auto seen = direct.find(surface);
        if (seen == direct.end() || !(fills_its_blur(found, surface) ||
                                      is_seen_from_its_edge(seen->second, std::get<2>(surface), rays, lens)))
            taken.insert(surface);
    }
    rule.takes = [taken, of_light, takes = rule.takes](const Highlight& light, const SheetKey& key,
                                                       const BrightSheet& sheet) {
        return taken.contains(of_light(light, key)) && takes(light, key, sheet);
    };
    take_highlights(sheets, rule);
    LightElsewhere less{.above = rule.above};
    if (taken.empty()) return less;
    for (const SurfaceSeen& surface : taken) less.ids.push_back(std::get<2>(surface));
    std::sort(less.ids.begin(), less.ids.end());
    less.ids.erase(std::unique(less.ids.begin(), less.ids.end()), less.ids.end());
    less.of = [taken = std::move(taken), moves](NodePath path, std::uint32_t parent_id, std::uint32_t id,
                                                const glm::dvec2& at) {
        return taken.contains(surface_seen(path, parent_id, id, at, moves));
    };
    if (!moves) {
        for (SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) measure_edges(*mesh, rays, less, lens);
    }
    return less;
}

}  // namespace postlens
