#include "focus/light_field/highlights_with_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/sample_hash.h"
#include "core/threads.h"

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

/// Rays per pixel that measure the edge of a highlight, along each axis. One ray in each of n x n squares of
/// a pixel measures the covered area with a standard deviation of about 0.45 / n^1.5 px^2, here 0.007 px^2.
constexpr int edge_rays = 16;

/// Whether the records of a highlight are farther apart than these rays.
bool is_coarse(const Highlight& light) {
    return light.area >= 1.0F / (edge_rays * edge_rays);
}

using Pixel = std::pair<int, int>;  ///< row, column

Pixel pixel_of(const Highlight& light) {
    return {static_cast<int>(std::floor(light.y)), static_cast<int>(std::floor(light.x))};
}

template <typename Visit>
void visit_around(const Pixel& pixel, const Visit& visit) {
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) visit(Pixel{pixel.first + y, pixel.second + x});
    }
}

/// The highlights of one surface.
struct BrightSurface {
    NodeIdentity node;
    std::span<const Highlight> lights;  ///< sorted by pixel

    [[nodiscard]] std::span<const Highlight> at(const Pixel& pixel) const;
    /// Whether the highlights of a pixel cover all of it.
    [[nodiscard]] bool fills(const Pixel& pixel) const;
    /// Whether nearer surfaces hide a part of the highlights in a pixel or beside it. Rays through the
    /// pinhole do not reach that part.
    [[nodiscard]] bool is_hidden_around(const Pixel& pixel) const;
    /// Returns the pixels that an edge of the bright part crosses or may cross, in the order of `lights`.
    [[nodiscard]] std::vector<Pixel> edge(const LightElsewhere& less) const;
    /// Returns some highlights of a pixel and its neighbours: one per square of 1/4 px.
    [[nodiscard]] std::vector<Highlight> recorded_around(const Pixel& pixel) const;
    /// Returns the highlights of a pixel as rays see them.
    [[nodiscard]] std::vector<Highlight> measured(const Pixel& pixel, const SightRays& rays,
                                                  const LightElsewhere& less) const;
};

std::span<const Highlight> BrightSurface::at(const Pixel& pixel) const {
    const auto first =
        std::lower_bound(lights.begin(), lights.end(), pixel,
                         [](const Highlight& light, const Pixel& to) { return pixel_of(light) < to; });
    return {first, std::find_if(first, lights.end(),
                                [&](const Highlight& light) { return pixel_of(light) != pixel; })};
}

bool BrightSurface::fills(const Pixel& pixel) const {
    double area = 0;
    for (const Highlight& light : at(pixel)) area += static_cast<double>(light.area);
    return area > 1 - 1e-6;
}

bool BrightSurface::is_hidden_around(const Pixel& pixel) const {
    bool any = false;
    visit_around(pixel, [&](const Pixel& near) {
        for (const Highlight& light : at(near)) any = any || light.hides != Hides::nothing;
    });
    return any;
}

std::vector<Pixel> BrightSurface::edge(const LightElsewhere& less) const {
    std::set<Pixel> seen, out;
    for (const Highlight& light : lights) {
        if (!is_coarse(light) || !seen.insert(pixel_of(light)).second) continue;
        visit_around(pixel_of(light), [&](const Pixel& near) {
            if (!out.contains(near) && !fills(near) && !is_hidden_around(near) &&
                less.of(node.path, node.parent_id, node.id, {near.second + 0.5, near.first + 0.5}))
                out.insert(near);
        });
    }
    return {out.begin(), out.end()};
}

std::vector<Highlight> BrightSurface::recorded_around(const Pixel& pixel) const {
    std::vector<Highlight> out;
    std::set<std::pair<int, int>> known;
    visit_around(pixel, [&](const Pixel& near) {
        for (const Highlight& light : at(near)) {
            const auto square = [](float px) { return static_cast<int>(std::floor(4 * px)); };
            if (known.insert({square(light.x), square(light.y)}).second) out.push_back(light);
        }
    });
    return out;
}

std::vector<Highlight> BrightSurface::measured(const Pixel& pixel, const SightRays& rays,
                                               const LightElsewhere& less) const {
    constexpr std::size_t count = std::size_t{edge_rays} * edge_rays;
    std::vector<SightLine> lines(count);
    const std::vector<NodeIdentity> nodes(count, node);
    std::vector<std::array<float, 3>> radiance(count);
    const std::uint64_t seed = mix64((std::uint64_t{static_cast<std::uint32_t>(pixel.first)} << 32U) |
                                     static_cast<std::uint32_t>(pixel.second));
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto within = [&](std::uint32_t square, std::uint32_t counter) {
            return (square + static_cast<double>(unit_float(random_word(seed, counter)))) / edge_rays;
        };
        lines[i] = {.x = pixel.second,
                    .y = pixel.first,
                    .place = {within(i % edge_rays, 2 * i), within(i / edge_rays, 2 * i + 1)},
                    .view = i};
    }
    rays.trace_elsewhere(lines, nodes, less, radiance);
    std::vector<Highlight> out, recorded;
    constexpr float area = 1.0F / static_cast<float>(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (radiance[i] == std::array<float, 3>{}) continue;
        if (recorded.empty()) recorded = recorded_around(pixel);
        const auto x = static_cast<float>(lines[i].x + lines[i].place.x),
                   y = static_cast<float>(lines[i].y + lines[i].place.y);
        // Depth and W are those of the nearest recorded highlight.
        Highlight light = *std::ranges::min_element(
            recorded, {}, [x, y](const Highlight& h) { return std::hypot(h.x - x, h.y - y); });
        light.x = x;
        light.y = y;
        light.area = area;
        for (std::size_t c = 0; c < 3; ++c) light.rgb[c] = area * radiance[i][c];
        out.push_back(light);
    }
    return out;
}

/// Replaces the highlights in pixels that the edge of a bright surface crosses.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less) {
    const auto order = [&](const Highlight& light) {
        const SheetKey& key = mesh.sheets[light.sheet].key;
        return std::tuple(key.path.bits(), key.parent_id, key.id);
    };
    std::ranges::stable_sort(mesh.highlights, {}, [&](const Highlight& light) {
        return std::tuple_cat(order(light), std::tuple(pixel_of(light)));
    });
    std::vector<Highlight> out;
    for (auto first = mesh.highlights.begin(); first != mesh.highlights.end();) {
        const auto last = std::find_if(first, mesh.highlights.end(),
                                       [&](const Highlight& light) { return order(light) != order(*first); });
        const SheetKey& key = mesh.sheets[first->sheet].key;
        const BrightSurface surface{{key.path, key.parent_id, key.id}, {first, last}};
        const std::vector<Pixel> edge = surface.edge(less);
        std::vector<std::vector<Highlight>> found(edge.size());
        parallel_for(edge.size(), [&](std::size_t i) { found[i] = surface.measured(edge[i], rays, less); });
        std::copy_if(first, last, std::back_inserter(out), [&](const Highlight& light) {
            return !std::ranges::binary_search(edge, pixel_of(light));
        });
        for (const std::vector<Highlight>& lights : found)
            out.insert(out.end(), lights.begin(), lights.end());
        first = last;
    }
    mesh.highlights = std::move(out);
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
    if (!moves) {
        for (SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) measure_edges(*mesh, rays, less);
    }
    return less;
}

}  // namespace postlens
