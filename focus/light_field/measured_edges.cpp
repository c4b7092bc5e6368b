#include "focus/light_field/measured_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "focus/light_field/square_search.h"

namespace postlens {
namespace {

/// The standard deviation of the lit area of a whole pixel that the rays find, in px^2, if no square is
/// divided again.
constexpr double pixel_error = 0.007;
/// Where this is too inaccurate, squares at the edge of the light are divided again, with square_rays x
/// square_rays rays in each new square. Into how many squares each is divided, along each axis, depends on
/// the highlight. The brightness of the whole blur of a small highlight depends on its area, so its edge is
/// measured most precisely.
constexpr int divided_at_edge = 4, divided_if_small = 6;
/// Highlights with an area below this are small, in px^2.
constexpr float small_light_px2 = 1;
/// Number of rays with which an area is searched if its squares are not divided again. Otherwise, these are
/// about ring_rays more, and rays_per_division * n^2 rays are added if each square at the edge is divided
/// into n x n.
constexpr std::size_t coarse_rays = 256, ring_rays = 144, rays_per_division = 60;
/// Largest error of a pixel's radiance that the search may cause without a second division.
constexpr double tolerated_radiance = 0.01;
/// Limits the time for measuring the edges of highlights with traced rays. If the edges cross too many
/// pixels, they are not measured at all. The limit is the fraction most_measured_share of all pixels. For
/// small images, where this would be very few pixels, it is least_measured pixels.
constexpr double most_measured_share = 1.0 / 32;
constexpr std::size_t least_measured = 4096;
/// Area, in px^2, from which a highlight counts as filling its pixel, so that the pixel contains no edge to
/// be measured. It is slightly below 1 because of rounding errors.
constexpr float filled = 0.9999F;

Pixel pixel_of(const Highlight& light) {
    return {static_cast<int>(std::floor(light.y)), static_cast<int>(std::floor(light.x))};
}

/// The highlights that rays found in a part of a pixel.
struct Measured {
    EdgeArea area;
    std::vector<Highlight> lights;
    /// Whether rays found the highlight at the borders of the searched rectangle `area`, so that it may
    /// continue beyond them. `low` states this for the left border (x) and the upper border (y), `high` for
    /// the right border (x) and the lower border (y).
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
    [[nodiscard]] std::vector<EdgeArea> edge(const LightElsewhere& less, const PatchLens& lens) const;
    /// Returns the rectangle within a pixel in which a highlight may lie. The rectangle surrounds the
    /// highlights that the sample file contains in this pixel and its eight neighbours, with a margin.
    [[nodiscard]] EdgeArea near_records(const Pixel& pixel) const;
    /// Finds the bright light of this surface within `area`, a rectangle in a pixel, by traced rays. The
    /// result contains one small highlight for each square of the rectangle in which rays hit bright light of
    /// this surface. If `refine` is true, squares at the edge of the light are divided again.
    [[nodiscard]] Measured measured(const EdgeArea& area, bool refine, const SightRays& rays,
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
    EdgeArea out{.pixel = pixel,
                 .recorded = pixel,
                 .divided = divided_if_small,
                 .begin = glm::dvec2(1),
                 .end = glm::dvec2(0)};
    for (int n = 0; n < 9; ++n) {
        for (const Highlight& light : at({pixel.first + n / 3 - 1, pixel.second + n % 3 - 1})) {
            // Enlarges the rectangle around each recorded sample of the highlight by `margin`, in px, because
            // the highlight may extend almost to the next sample. sqrt(light.area) is the width of the square
            // that the sample represents.
            const double margin = 2 * std::sqrt(static_cast<double>(light.area));
            const glm::dvec2 place(light.x - static_cast<float>(pixel.second),
                                   light.y - static_cast<float>(pixel.first));
            out.begin = glm::min(out.begin, place - margin);
            out.end = glm::max(out.end, place + margin);
        }
    }
    out.begin = glm::max(out.begin, 0.0);
    out.end = glm::min(out.end, 1.0);
    return out.begin.x < out.end.x && out.begin.y < out.end.y ? out.in_squares() : out;
}

std::vector<EdgeArea> BrightSurface::edge(const LightElsewhere& less, const PatchLens& lens) const {
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
        /// Largest error of a pixel's radiance that the search without a second division may cause here.
        double radiance_error = 0;
    };
    std::vector<Covered> covered(width * height);
    for (const Highlight& light : lights) {
        const Pixel pixel = pixel_of(light);
        Covered& at = covered[static_cast<std::size_t>(pixel.first - origin.first) * width +
                              static_cast<std::size_t>(pixel.second - origin.second)];
        at.area += light.area;
        at.is_hidden = at.is_hidden || light.hides != Hides::nothing;
        at.is_fine = at.is_fine || light.area < 1.0F / coarse_rays;
        const double blur_px = lens.least_blur_px(light.w);
        const auto radiance =
            static_cast<double>(std::max({light.rgb[0], light.rgb[1], light.rgb[2]}) / light.area);
        at.radiance_error =
            std::max(at.radiance_error, pixel_error * radiance / (1 + std::numbers::pi * blur_px * blur_px));
    }
    std::vector<EdgeArea> out;
    for (std::size_t y = 1; y + 1 < height; ++y) {
        for (std::size_t x = 1; x + 1 < width; ++x) {
            if (covered[y * width + x].area > filled) continue;
            bool any = false, is_hidden = false, is_fine = false, is_bright = false;
            for (std::size_t row = y - 1; row <= y + 1; ++row) {
                for (std::size_t column = x - 1; column <= x + 1; ++column) {
                    const Covered& of = covered[row * width + column];
                    any = any || of.area > 0;
                    is_hidden = is_hidden || of.is_hidden;
                    is_fine = is_fine || of.is_fine;
                    is_bright = is_bright || of.radiance_error > tolerated_radiance;
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
            } else if ((is_bright || !is_fine) && node.path.bits() == 0) {
                out.push_back({.pixel = pixel,
                               .recorded = pixel,
                               .divided = is_bright ? divided_at_edge : 1,
                               .has_fine_records = is_fine});
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

Measured BrightSurface::measured(const EdgeArea& area, bool refine, const SightRays& rays,
                                 const LightElsewhere& less) const {
    const Pixel& pixel = area.pixel;
    refine = refine && area.divided > 1;
    SquareSearch by(node, pixel, rays, less);
    SquareGrid grid(area, refine);
    grid.search(by);
    if (refine) {
        grid.divide(by, [&](const Square& square) {
            const glm::dvec2 end = square.begin + grid.side_px();
            return std::ranges::any_of(at(pixel), [&](const Highlight& light) {
                const double x = static_cast<double>(light.x) - pixel.second,
                             y = static_cast<double>(light.y) - pixel.first;
                return light.area < grid.side_px() * grid.side_px() && x >= square.begin.x && x < end.x &&
                       y >= square.begin.y && y < end.y && square.found < rays_per_square;
            });
        });
    }
    Measured out{.area = area, .lights = {}};
    std::vector<SightLine> through;
    const auto add = [&](const Square& square, double side_px) {
        if (square.found == 0) return;
        // The light of a square is described by a smaller square around the mean of the hits. It must not
        // extend beyond the square, or light would leave the pixel.
        const double share = static_cast<double>(square.found) / rays_per_square;
        const glm::dvec2 half(side_px * std::sqrt(share) / 2),
            at = glm::clamp(square.at / static_cast<double>(square.found), square.begin + half,
                            square.begin + side_px - half);
        const auto x = static_cast<float>(pixel.second + at.x), y = static_cast<float>(pixel.first + at.y);
        Highlight light = nearest(area.recorded, x, y);
        light.x = x;
        light.y = y;
        const auto px2_per_ray = static_cast<float>(side_px * side_px / rays_per_square);
        light.area = static_cast<float>(square.found) * px2_per_ray;
        for (std::size_t c = 0; c < 3; ++c) light.rgb[c] = square.rgb[c] * px2_per_ray;
        out.lights.push_back(light);
        through.push_back(line_through({x, y}));
    };
    for (int y = 0; y < grid.size().y; ++y) {
        for (int x = 0; x < grid.size().x; ++x) {
            if (grid.divided(x, y).empty()) add(grid.at(x, y), grid.side_px());
            for (const Square& square : grid.divided(x, y)) add(square, grid.side_px() / area.divided);
        }
    }
    out.low = {grid.touches(0, -1), grid.touches(1, -1)};
    out.high = {grid.touches(0, 1), grid.touches(1, 1)};
    measure_slopes(out.lights, through, node, rays);
    return out;
}

/// Returns the areas in which to search next for the highlight that `m` describes. Where the rays found light
/// at the border of the searched area, the highlight may continue beyond it. So the result contains a larger
/// area in the same pixel. If the searched area ends there at the border of the pixel, the result also
/// contains the neighbouring pixel.
std::vector<EdgeArea> continued(const Measured& m) {
    std::vector<EdgeArea> out;
    EdgeArea larger = m.area;
    const glm::dvec2 by = (m.area.end - m.area.begin) / 2.0;
    for (int axis = 0; axis < 2; ++axis) {
        if (m.low[axis]) larger.begin[axis] = std::max(larger.begin[axis] - by[axis], 0.0);
        if (m.high[axis]) larger.end[axis] = std::min(larger.end[axis] + by[axis], 1.0);
    }
    larger = larger.in_squares();
    constexpr double same_px = 1e-6;
    const auto grows = [&](int axis) {
        return larger.begin[axis] < m.area.begin[axis] - same_px ||
               larger.end[axis] > m.area.end[axis] + same_px;
    };
    if (grows(0) || grows(1)) out.push_back(larger);
    const auto crosses = [&](int axis, int to) {
        return to == 0 ||
               (to < 0 ? m.low[axis] && m.area.begin[axis] == 0 : m.high[axis] && m.area.end[axis] == 1);
    };
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            if ((dx != 0 || dy != 0) && crosses(0, dx) && crosses(1, dy))
                out.push_back({.pixel = {m.area.pixel.first + dy, m.area.pixel.second + dx},
                               .recorded = m.area.recorded,
                               .divided = divided_if_small});
        }
    }
    return out;
}

}  // namespace

void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less,
                   const PatchLens& lens) {
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
    std::size_t pixels = 0, extra_rays = 0;
    const auto extra_rays_of = [](const EdgeArea& area) {
        return area.divided > 1
                   ? ring_rays + rays_per_division * static_cast<std::size_t>(area.divided * area.divided)
                   : 0;
    };
    for (auto first = mesh.highlights.begin(); first != mesh.highlights.end();) {
        const auto last = std::find_if(first, mesh.highlights.end(), [&](const Highlight& light) {
            return node_of(light) != node_of(*first);
        });
        const BrightSurface surface{node_of(*first), {first, last}};
        edges.push_back({surface, surface.edge(less, lens)});
        pixels += edges.back().areas.size();
        for (const EdgeArea& area : edges.back().areas) extra_rays += extra_rays_of(area);
        first = last;
    }
    const std::size_t most = std::max(least_measured,
                                      static_cast<std::size_t>(most_measured_share *
                                                               static_cast<double>(mesh.fine.size()))),
                      most_rays = most * coarse_rays;
    const auto rays_in_all = [&](bool refine) { return pixels * coarse_rays + (refine ? extra_rays : 0); };
    const bool refine = rays_in_all(true) <= most_rays;
    if (!refine) {
        // Without a second division, the records are more precise where they are closer together than the
        // rays.
        for (Edge& edge : edges)
            pixels -= std::erase_if(edge.areas, [](const EdgeArea& area) { return area.has_fine_records; });
    }
    if (pixels > most) return;
    // Traced rays search pixels for highlights, in several rounds. If a highlight touches the border of its
    // pixel, the next round also searches the neighbouring pixel. A narrow highlight may continue there,
    // although the file has no sample of it.
    for (bool any = true; any && rays_in_all(refine) <= most_rays;) {
        std::vector<std::pair<const Edge*, const EdgeArea*>> tasks;
        for (const Edge& edge : edges) {
            for (const EdgeArea& area : edge.areas) tasks.emplace_back(&edge, &area);
        }
        std::vector<Measured> now(tasks.size());
        parallel_for(tasks.size(), [&](std::size_t i) {
            const auto& [edge, area] = tasks[i];
            now[i] = edge->surface.measured(*area, refine, rays, less);
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
            areas.clear();
            for (const auto& [pixel, area] : next) {
                areas.push_back(area);
                extra_rays += extra_rays_of(area);
            }
            any = any || !areas.empty();
        }
    }
    // If the rays were used up, light may continue beyond the areas that were searched last. The records of
    // their pixels stay.
    for (Edge& edge : edges) {
        for (const EdgeArea& area : edge.areas) edge.found.erase(area.pixel);
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
