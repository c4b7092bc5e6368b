#include "focus/light_field/measured_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/sample_hash.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// Rays per pixel that measure the edge of a highlight, along each axis. One ray in each of n x n squares of
/// a pixel measures the covered area with a standard deviation of about 0.45 / n^1.5 px^2, here 0.007 px^2.
constexpr int edge_rays = 16;
/// A pixel is divided into n x n squares. The rays of one square that hit the light form one highlight.
constexpr int edge_squares = 8;
/// Largest number of pixels that are measured: a share of the cells of all sheets, but at least
/// least_measured. If more pixels contain an edge, as in a texture that is brighter than the limit here and
/// there, none are measured.
constexpr double most_measured_share = 1.0 / 32;
constexpr std::size_t least_measured = 4096;
/// Area of the highlights of a pixel, px^2, from which they fill it.
constexpr float filled = 0.9999F;

using Pixel = std::pair<int, int>;  ///< row, column

Pixel pixel_of(const Highlight& light) {
    return {static_cast<int>(std::floor(light.y)), static_cast<int>(std::floor(light.x))};
}

/// The highlights of one surface that is seen directly.
struct BrightSurface {
    std::uint32_t id = 0;
    std::span<const Highlight> lights;  ///< sorted by pixel

    [[nodiscard]] std::span<const Highlight> at(const Pixel& pixel) const;
    /// Returns, in order, the pixels that an edge of the bright part crosses or may cross. Leaves out pixels
    /// in which rays through the pinhole do not measure the edge better than the records: those where the
    /// records of the pixel or a neighbour are closer together than the rays, and those where a nearer
    /// surface hides a part.
    [[nodiscard]] std::vector<Pixel> edge(const LightElsewhere& less) const;
    /// Returns the highlights of a pixel as rays see them.
    [[nodiscard]] std::vector<Highlight> measured(const Pixel& pixel, const SightRays& rays,
                                                  const LightElsewhere& less) const;
    /// Returns the highlight nearest to a position in a pixel. The pixel or a neighbour must contain one.
    [[nodiscard]] const Highlight& nearest(const Pixel& pixel, float x, float y) const;
};

std::span<const Highlight> BrightSurface::at(const Pixel& pixel) const {
    const auto first =
        std::lower_bound(lights.begin(), lights.end(), pixel,
                         [](const Highlight& light, const Pixel& to) { return pixel_of(light) < to; });
    return {first, std::find_if(first, lights.end(),
                                [&](const Highlight& light) { return pixel_of(light) != pixel; })};
}

std::vector<Pixel> BrightSurface::edge(const LightElsewhere& less) const {
    Pixel first = pixel_of(lights.front()), last = first;
    for (const Highlight& light : lights) {
        const Pixel pixel = pixel_of(light);
        first = {std::min(first.first, pixel.first), std::min(first.second, pixel.second)};
        last = {std::max(last.first, pixel.first), std::max(last.second, pixel.second)};
    }
    // The pixels around the highlights, with two more rows and columns on each side.
    const Pixel origin{first.first - 2, first.second - 2};
    const auto width = static_cast<std::size_t>(last.second - first.second) + 5,
               height = static_cast<std::size_t>(last.first - first.first) + 5;
    struct Covered {
        float area = 0;         ///< px^2
        bool is_known = false;  ///< whether the records are better than rays
    };
    std::vector<Covered> covered(width * height);
    for (const Highlight& light : lights) {
        const Pixel pixel = pixel_of(light);
        Covered& at = covered[static_cast<std::size_t>(pixel.first - origin.first) * width +
                              static_cast<std::size_t>(pixel.second - origin.second)];
        at.area += light.area;
        at.is_known =
            at.is_known || light.hides != Hides::nothing || light.area < 1.0F / (edge_rays * edge_rays);
    }
    std::vector<Pixel> out;
    for (std::size_t y = 1; y + 1 < height; ++y) {
        for (std::size_t x = 1; x + 1 < width; ++x) {
            if (covered[y * width + x].area > filled) continue;
            bool any = false, is_known = false;
            for (std::size_t row = y - 1; row <= y + 1; ++row) {
                for (std::size_t column = x - 1; column <= x + 1; ++column) {
                    any = any || covered[row * width + column].area > 0;
                    is_known = is_known || covered[row * width + column].is_known;
                }
            }
            const Pixel pixel{origin.first + static_cast<int>(y), origin.second + static_cast<int>(x)};
            if (any && !is_known && less.of({}, 0, id, {pixel.second + 0.5, pixel.first + 0.5}))
                out.push_back(pixel);
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

std::vector<Highlight> BrightSurface::measured(const Pixel& pixel, const SightRays& rays,
                                               const LightElsewhere& less) const {
    constexpr std::size_t count = std::size_t{edge_rays} * edge_rays;
    constexpr std::uint32_t per_square = edge_rays / edge_squares;
    std::vector<SightLine> lines(count);
    const std::vector<NodeIdentity> nodes(count, NodeIdentity{.id = id});
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
    struct Sum {
        std::array<float, 3> rgb{};
        glm::dvec2 at{0};
        int rays = 0;
        SightLine one;  ///< the last of the rays
    };
    std::array<Sum, std::size_t{edge_squares} * edge_squares> sums;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (radiance[i] == std::array<float, 3>{}) continue;
        Sum& sum = sums[i / edge_rays / per_square * edge_squares + i % edge_rays / per_square];
        for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += radiance[i][c];
        sum.at += lines[i].place;
        ++sum.rays;
        sum.one = lines[i];
    }
    std::vector<Highlight> out;
    lines.clear();
    for (const Sum& sum : sums) {
        if (sum.rays == 0) continue;
        const auto x = static_cast<float>(pixel.second + sum.at.x / sum.rays),
                   y = static_cast<float>(pixel.first + sum.at.y / sum.rays);
        Highlight light = nearest(pixel, x, y);
        light.x = x;
        light.y = y;
        light.area = static_cast<float>(sum.rays) / static_cast<float>(count);
        for (std::size_t c = 0; c < 3; ++c) light.rgb[c] = sum.rgb[c] / static_cast<float>(count);
        out.push_back(light);
        lines.push_back(sum.one);
    }
    std::vector<glm::dvec3> inverse_z(lines.size());
    rays.inverse_depths(lines, id, inverse_z);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (inverse_z[i].x == 0) continue;
        Highlight& light = out[i];
        light.inverse_z = static_cast<float>(inverse_z[i].x);
        light.slope = glm::vec2(inverse_z[i].y, inverse_z[i].z);
        light.w = Mat2::isotropic(light.inverse_z);
    }
    return out;
}

}  // namespace

void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less) {
    const auto id_of = [&](const Highlight& light) { return mesh.sheets[light.sheet].key.id; };
    std::ranges::stable_sort(mesh.highlights, {}, [&](const Highlight& light) {
        return std::tuple(id_of(light), pixel_of(light));
    });
    struct Edge {
        BrightSurface surface;
        std::vector<Pixel> pixels;
    };
    std::vector<Edge> edges;
    std::size_t pixels = 0;
    for (auto first = mesh.highlights.begin(); first != mesh.highlights.end();) {
        const auto last = std::find_if(first, mesh.highlights.end(),
                                       [&](const Highlight& light) { return id_of(light) != id_of(*first); });
        const BrightSurface surface{id_of(*first), {first, last}};
        edges.push_back({surface, surface.edge(less)});
        pixels += edges.back().pixels.size();
        first = last;
    }
    if (pixels > least_measured &&
        static_cast<double>(pixels) > most_measured_share * static_cast<double>(mesh.fine.size()))
        return;
    std::vector<Highlight> out;
    for (const auto& [surface, edge] : edges) {
        std::vector<std::vector<Highlight>> found(edge.size());
        parallel_for(edge.size(), [&, &of = surface, &at = edge](std::size_t i) {
            found[i] = of.measured(at[i], rays, less);
        });
        std::copy_if(surface.lights.begin(), surface.lights.end(), std::back_inserter(out),
                     [&at = edge](const Highlight& light) {
                         return !std::ranges::binary_search(at, pixel_of(light));
                     });
        for (const std::vector<Highlight>& lights : found)
            out.insert(out.end(), lights.begin(), lights.end());
    }
    mesh.highlights = std::move(out);
}

}  // namespace postlens
