#include "focus/light_field/measured_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/sample_hash.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// If the edge of a highlight crosses a pixel, edge_rays x edge_rays rays measure which area of the pixel the
/// highlight covers. The standard deviation of this area is about 0.007 px^2.
constexpr std::size_t edge_rays = 16;
/// Highlights with an area below small_light_px2, in px^2, are measured with more rays: up to finest_rays x
/// finest_rays per pixel. With this number, the error of the measured area is at most 1 %.
constexpr float small_light_px2 = 1;
constexpr std::size_t finest_rays = 64;
/// Traced rays search a pixel, or a rectangle in it, for the light of a highlight. This area is divided into
/// edge_squares x edge_squares squares. All rays that hit the light in one square are combined into one small
/// highlight.
constexpr int edge_squares = 8;
/// Limits the time for measuring the edges of highlights with traced rays. If the edges cross too many
/// pixels, they are not measured at all. Too many means more than the fraction most_measured_share of all
/// pixels, and also more than least_measured pixels.
constexpr double most_measured_share = 1.0 / 32;
constexpr std::size_t least_measured = 4096;
/// Highlights that cover more than this area of a pixel, in px^2, count as filling it.
constexpr float filled = 0.9999F;

using Pixel = std::pair<int, int>;  ///< row, column

Pixel pixel_of(const Highlight& light) {
    return {static_cast<int>(std::floor(light.y)), static_cast<int>(std::floor(light.x))};
}

/// A rectangle within a pixel in which traced rays measure the area of a highlight. `begin` and `end` are its
/// upper left and its lower right corner, in px from the pixel's upper left corner.
struct EdgeArea {
    Pixel pixel;
    Pixel recorded = pixel;  ///< a pixel with a record of the light in it or in one of its eight neighbours
    bool is_small = false;   ///< whether the light is small (small_light_px2)
    glm::dvec2 begin{0}, end{1};
};

/// The highlights that rays found in a part of a pixel.
struct Measured {
    EdgeArea area;
    std::vector<Highlight> lights;
    /// Whether the highlight touches the borders of the searched rectangle `area`. `low` states this for the
    /// left border (x) and the upper border (y), `high` for the right border (x) and the lower border (y).
    glm::bvec2 low{false}, high{false};
};

/// Highlights of one object that are seen by the same sequence of reflections and transmissions.
struct BrightSurface {
    NodeIdentity node;
    std::span<const Highlight> lights;  ///< sorted by pixel

    [[nodiscard]] std::span<const Highlight> at(const Pixel& pixel) const;
    /// Returns the pixels at the edge of this bright surface in which traced rays measure the bright area
    /// more precisely than the samples in the file do. `less` states which bright light is added to the image
    /// as highlights. Pixels with other light are left out.
    [[nodiscard]] std::vector<EdgeArea> edge(const LightElsewhere& less) const;
    /// Returns the rectangle within a pixel in which a highlight may lie. The rectangle surrounds the
    /// highlights that the sample file contains in this pixel and its eight neighbours, with a margin.
    [[nodiscard]] EdgeArea near_records(const Pixel& pixel) const;
    /// Finds the bright light of this surface within `area`, a rectangle in a pixel. Traces `across` x
    /// `across` rays through the rectangle, and divides it into small squares. The result contains one small
    /// highlight for each square in which a ray hits bright light of this surface.
    [[nodiscard]] Measured measured(const EdgeArea& area, std::size_t across, const SightRays& rays,
                                    const LightElsewhere& less) const;
    [[nodiscard]] const Highlight& nearest(const Pixel& pixel, float x, float y) const;
};

std::span<const Highlight> BrightSurface::at(const Pixel& pixel) const {
    const auto first =
        std::lower_bound(lights.begin(), lights.end(), pixel,
                         [](const Highlight& light, const Pixel& to) { return pixel_of(light) < to; });
    return {first, std::find_if(first, lights.end(),
                                [&](const Highlight& light) { return pixel_of(light) != pixel; })};
}

EdgeArea BrightSurface::near_records(const Pixel& pixel) const {
    EdgeArea out{
        .pixel = pixel, .recorded = pixel, .is_small = true, .begin = glm::dvec2(1), .end = glm::dvec2(0)};
    for (int n = 0; n < 9; ++n) {
        for (const Highlight& light : at({pixel.first + n / 3 - 1, pixel.second + n % 3 - 1})) {
            // The highlight may extend from its sample almost to the next sample, which is `margin` px away.
            const double margin = 2 * std::sqrt(static_cast<double>(light.area));
            const glm::dvec2 place(light.x - static_cast<float>(pixel.second),
                                   light.y - static_cast<float>(pixel.first));
            out.begin = glm::min(out.begin, place - margin);
            out.end = glm::max(out.end, place + margin);
        }
    }
    out.begin = glm::max(out.begin, 0.0);
    out.end = glm::min(out.end, 1.0);
    return out;
}

std::vector<EdgeArea> BrightSurface::edge(const LightElsewhere& less) const {
    Pixel first = pixel_of(lights.front()), last = first;
    for (const Highlight& light : lights) {
        const Pixel pixel = pixel_of(light);
        first = {std::min(first.first, pixel.first), std::min(first.second, pixel.second)};
        last = {std::max(last.first, pixel.first), std::max(last.second, pixel.second)};
    }
    const Pixel origin{first.first - 2, first.second - 2};
    const auto width = static_cast<std::size_t>(last.second - first.second) + 5,
               height = static_cast<std::size_t>(last.first - first.first) + 5;
    struct Covered {
        float area = 0;          ///< px^2
        bool is_hidden = false;  ///< whether a nearer surface hides a part
        bool is_fine = false;    ///< whether the records are closer together than the rays
    };
    std::vector<Covered> covered(width * height);
    for (const Highlight& light : lights) {
        const Pixel pixel = pixel_of(light);
        Covered& at = covered[static_cast<std::size_t>(pixel.first - origin.first) * width +
                              static_cast<std::size_t>(pixel.second - origin.second)];
        at.area += light.area;
        at.is_hidden = at.is_hidden || light.hides != Hides::nothing;
        at.is_fine = at.is_fine || light.area < 1.0F / (edge_rays * edge_rays);
    }
    std::vector<EdgeArea> out;
    for (std::size_t y = 1; y + 1 < height; ++y) {
        for (std::size_t x = 1; x + 1 < width; ++x) {
            if (covered[y * width + x].area > filled) continue;
            bool any = false, is_hidden = false, is_fine = false;
            for (std::size_t row = y - 1; row <= y + 1; ++row) {
                for (std::size_t column = x - 1; column <= x + 1; ++column) {
                    const Covered& of = covered[row * width + column];
                    any = any || of.area > 0;
                    is_hidden = is_hidden || of.is_hidden;
                    is_fine = is_fine || of.is_fine;
                }
            }
            const Pixel pixel{origin.first + static_cast<int>(y), origin.second + static_cast<int>(x)};
            if (!any || is_hidden ||
                !less.of(node.path, node.parent_id, node.id, {pixel.second + 0.5, pixel.first + 0.5}))
                continue;
            float nearby = 0;
            for (std::size_t row = std::max<std::size_t>(y, 2) - 2; row <= std::min(y + 2, height - 1);
                 ++row) {
                for (std::size_t column = std::max<std::size_t>(x, 2) - 2;
                     column <= std::min(x + 2, width - 1); ++column)
                    nearby += covered[row * width + column].area;
            }
            if (nearby < small_light_px2) {
                const EdgeArea area = near_records(pixel);
                if (area.begin.x < area.end.x && area.begin.y < area.end.y) out.push_back(area);
            } else if (!is_fine && node.path.bits() == 0) {
                out.push_back({pixel, pixel});
            }
        }
    }
    return out;
}

const Highlight& BrightSurface::nearest(const Pixel& pixel, float x, float y) const {
    const Highlight* out = nullptr;
    float least = std::numeric_limits<float>::infinity();
    for (int n = 0; n < 9; ++n) {
        for (const Highlight& light : at({pixel.first + n / 3 - 1, pixel.second + n % 3 - 1})) {
            const float dx = light.x - x, dy = light.y - y, distance = dx * dx + dy * dy;
            if (distance >= least) continue;
            least = distance;
            out = &light;
        }
    }
    return *out;
}

/// Measures the depth and slope of a surface at the positions of its highlights `lights`, and stores both in
/// `lights`. For this, it traces lines[i], the ray through the pinhole to lights[i]. Does nothing if the
/// highlights are seen in mirrors or through glass.
void measure_slopes(std::span<Highlight> lights, std::span<const SightLine> lines, const NodeIdentity& node,
                    const SightRays& rays) {
    if (node.path.bits() != 0) return;
    std::vector<glm::dvec3> inverse_z(lines.size());
    rays.inverse_depths(lines, node.id, inverse_z);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (inverse_z[i].x == 0) continue;
        Highlight& light = lights[i];
        light.inverse_z = static_cast<float>(inverse_z[i].x);
        light.slope = glm::vec2(inverse_z[i].y, inverse_z[i].z);
        light.w = Mat2::isotropic(light.inverse_z);
    }
}

/// Measures the depth and slope of a surface at each of its recorded highlights, and stores both in `lights`.
/// One ray through the pinhole measures both, because the ray tracer also returns the gradient of the depth.
void measure_slopes(std::span<Highlight> lights, const NodeIdentity& node, const SightRays& rays) {
    constexpr std::size_t lines_per_task = 4096;
    parallel_for((lights.size() + lines_per_task - 1) / lines_per_task, [&](std::size_t task) {
        const std::span part = lights.subspan(
            task * lines_per_task, std::min(lines_per_task, lights.size() - task * lines_per_task));
        std::vector<SightLine> lines;
        for (const Highlight& light : part) lines.push_back(line_through({light.x, light.y}));
        measure_slopes(part, lines, node, rays);
    });
}

Measured BrightSurface::measured(const EdgeArea& area, std::size_t across, const SightRays& rays,
                                 const LightElsewhere& less) const {
    const Pixel& pixel = area.pixel;
    const auto columns = static_cast<std::uint32_t>(across);
    const std::uint32_t count = columns * columns, per_square = columns / edge_squares;
    const glm::dvec2 size = area.end - area.begin;
    const auto px2_per_ray = static_cast<float>(size.x * size.y / count);
    std::vector<SightLine> lines(count);
    const std::vector<NodeIdentity> nodes(count, node);
    std::vector<std::array<float, 3>> radiance(count);
    const std::uint64_t seed = mix64((std::uint64_t{static_cast<std::uint32_t>(pixel.first)} << 32U) |
                                     static_cast<std::uint32_t>(pixel.second));
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto within = [&](std::uint32_t square, std::uint32_t counter) {
            return (square + static_cast<double>(unit_float(random_word(seed, counter)))) / columns;
        };
        lines[i] = {.x = pixel.second,
                    .y = pixel.first,
                    .place = area.begin +
                             size * glm::dvec2(within(i % columns, 2 * i), within(i / columns, 2 * i + 1)),
                    .view = i};
    }
    rays.trace_elsewhere(lines, nodes, less, radiance);
    struct Sum {
        std::array<float, 3> rgb{};
        glm::dvec2 at{0};
        int rays = 0;
        SightLine one;  ///< the last of the rays
    };
    std::array<Sum, std::size_t{edge_squares} * edge_squares> sums;
    Measured out{.area = area, .lights = {}};
    for (std::uint32_t i = 0; i < count; ++i) {
        if (radiance[i] == std::array<float, 3>{}) continue;
        const glm::uvec2 at(i % columns, i / columns);
        out.low = out.low || glm::equal(at, glm::uvec2(0));
        out.high = out.high || glm::equal(at, glm::uvec2(columns - 1));
        Sum& sum = sums[i / columns / per_square * edge_squares + i % columns / per_square];
        for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += radiance[i][c];
        sum.at += lines[i].place;
        ++sum.rays;
        sum.one = lines[i];
    }
    lines.clear();
    for (const Sum& sum : sums) {
        if (sum.rays == 0) continue;
        const auto x = static_cast<float>(pixel.second + sum.at.x / sum.rays),
                   y = static_cast<float>(pixel.first + sum.at.y / sum.rays);
        Highlight light = nearest(area.recorded, x, y);
        light.x = x;
        light.y = y;
        light.area = static_cast<float>(sum.rays) * px2_per_ray;
        for (std::size_t c = 0; c < 3; ++c) light.rgb[c] = sum.rgb[c] * px2_per_ray;
        out.lights.push_back(light);
        lines.push_back(sum.one);
    }
    measure_slopes(out.lights, lines, node, rays);
    return out;
}

/// Returns the areas in which to search next. If the rays found a highlight that touches the border of the
/// searched area, the highlight may continue beyond it. So the result contains an enlarged area in the same
/// pixel, and the neighbouring pixels if the pixel's own border is touched.
std::vector<EdgeArea> continued(const Measured& m) {
    std::vector<EdgeArea> out;
    EdgeArea larger = m.area;
    const glm::dvec2 by = (m.area.end - m.area.begin) / 2.0;
    for (int axis = 0; axis < 2; ++axis) {
        if (m.low[axis]) larger.begin[axis] = std::max(larger.begin[axis] - by[axis], 0.0);
        if (m.high[axis]) larger.end[axis] = std::min(larger.end[axis] + by[axis], 1.0);
    }
    if (larger.begin != m.area.begin || larger.end != m.area.end) out.push_back(larger);
    const auto crosses = [&](int axis, int to) {
        return to == 0 ||
               (to < 0 ? m.low[axis] && m.area.begin[axis] == 0 : m.high[axis] && m.area.end[axis] == 1);
    };
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            if ((dx != 0 || dy != 0) && crosses(0, dx) && crosses(1, dy))
                out.push_back({.pixel = {m.area.pixel.first + dy, m.area.pixel.second + dx},
                               .recorded = m.area.recorded,
                               .is_small = true});
        }
    }
    return out;
}

}  // namespace

void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less) {
    const auto node_of = [&](const Highlight& light) {
        const SheetKey& key = mesh.sheets[light.sheet].key;
        return NodeIdentity{key.path, key.parent_id, key.id};
    };
    std::ranges::stable_sort(mesh.highlights, {}, [&](const Highlight& light) {
        const NodeIdentity node = node_of(light);
        return std::tuple(node.path.bits(), node.parent_id, node.id, pixel_of(light));
    });
    struct Edge {
        BrightSurface surface;
        std::vector<EdgeArea> areas;  ///< to be measured next
        std::map<Pixel, Measured> found = {};
    };
    std::vector<Edge> edges;
    std::size_t pixels = 0, small = 0;
    for (auto first = mesh.highlights.begin(); first != mesh.highlights.end();) {
        const auto last = std::find_if(first, mesh.highlights.end(), [&](const Highlight& light) {
            return node_of(light) != node_of(*first);
        });
        const BrightSurface surface{node_of(*first), {first, last}};
        edges.push_back({surface, surface.edge(less)});
        pixels += edges.back().areas.size();
        small += static_cast<std::size_t>(std::ranges::count(edges.back().areas, true, &EdgeArea::is_small));
        first = last;
    }
    const std::size_t most = std::max(least_measured,
                                      static_cast<std::size_t>(most_measured_share *
                                                               static_cast<double>(mesh.fine.size()))),
                      most_rays = most * edge_rays * edge_rays;
    if (pixels > most) return;
    std::size_t finest = finest_rays;
    const auto rays_of = [&](std::size_t across) {
        return small * across * across + (pixels - small) * edge_rays * edge_rays;
    };
    while (finest > edge_rays && rays_of(finest) > most_rays) finest /= 2;
    // Traced rays search pixels for highlights, in several rounds. If a highlight touches the border of its
    // pixel, the next round also searches the neighbouring pixel. A narrow highlight may continue there,
    // although the file has no sample of it.
    for (bool any = true; any && rays_of(finest) <= most_rays;) {
        std::vector<std::pair<const Edge*, const EdgeArea*>> tasks;
        for (const Edge& edge : edges) {
            for (const EdgeArea& area : edge.areas) tasks.emplace_back(&edge, &area);
        }
        std::vector<Measured> now(tasks.size());
        parallel_for(tasks.size(), [&](std::size_t i) {
            const auto& [edge, area] = tasks[i];
            now[i] = edge->surface.measured(*area, area->is_small ? finest : edge_rays, rays, less);
        });
        any = false;
        auto next_measured = now.begin();
        for (auto& [surface, areas, found] : edges) {
            for (const EdgeArea& area : areas) found[area.pixel] = std::move(*next_measured++);
            std::map<Pixel, EdgeArea> next;
            for (const EdgeArea& area : areas) {
                for (const EdgeArea& more : continued(found[area.pixel])) {
                    const bool is_known = found.contains(more.pixel) || !surface.at(more.pixel).empty();
                    if (more.pixel == area.pixel || !is_known) next.emplace(more.pixel, more);
                }
            }
            pixels += next.size();
            small += next.size();
            areas.clear();
            for (const auto& [pixel, area] : next) areas.push_back(area);
            any = any || !areas.empty();
        }
    }
    std::vector<std::vector<Highlight>> out(edges.size());
    parallel_for(edges.size(), [&](std::size_t i) {
        const Edge& edge = edges[i];
        std::ranges::copy_if(edge.surface.lights, std::back_inserter(out[i]),
                             [&](const Highlight& light) { return !edge.found.contains(pixel_of(light)); });
        measure_slopes(out[i], edge.surface.node, rays);
        for (const auto& [pixel, m] : edge.found)
            out[i].insert(out[i].end(), m.lights.begin(), m.lights.end());
    });
    mesh.highlights.clear();
    for (const std::vector<Highlight>& of_surface : out)
        mesh.highlights.insert(mesh.highlights.end(), of_surface.begin(), of_surface.end());
}

}  // namespace postlens
