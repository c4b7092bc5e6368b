#include "tracer/shading/light_means.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sample_hash.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double target_noise = 2.0 / 255;  // standard deviation in one record, as a fraction of white
constexpr int fewest_cells = 4;
constexpr int first_points = 12;  // eight on the outline and one in each quarter
constexpr double same_transmittance = 1e-3;

dvec2 jitter(std::uint64_t seed, std::uint32_t index) {
    return {static_cast<double>(unit_float(random_word(seed, 2 * index))),
            static_cast<double>(unit_float(random_word(seed, 2 * index + 1)))};
}

// Returns a random point (u, v) of an area light, within cell (i, j) of k x k cells.
dvec2 cell_point(std::uint64_t seed, int k, int i, int j) {
    return (dvec2(i, j) + jitter(seed, static_cast<std::uint32_t>(k * k + j * k + i))) /
           static_cast<double>(k);
}

// Returns point number i of the twelve points of an area light whose visibility is tested first. Points 0 to
// 7 lie on the outline of the light, and points 8 to 11 lie inside. On a spherical light, the points on the
// outline are 45 degrees apart and are rotated together by a random angle. Without this rotation, occluders
// between the points would always be missed.
dvec2 first_point(const PlacedLight& light, std::uint64_t seed, int i) {
    if (i >= 8) return cell_point(seed, 2, i % 2, i / 2 % 2);
    constexpr double inside = 1 - 1e-6;
    if (light.light->kind == Light::Kind::sphere) return {inside, (i + jitter(seed, 0).x) / 8};
    constexpr std::array<dvec2, 8> square{dvec2(0, 0), dvec2(0.5, 0), dvec2(1, 0), dvec2(1, 0.5),
                                          dvec2(1, 1), dvec2(0.5, 1), dvec2(0, 1), dvec2(0, 0.5)};
    return square[static_cast<std::size_t>(i)];
}

Lit lit_at(const ExtentLit& p, const dvec2& uv) {
    return lit_by(*p.light, light_point(*p.light, p.surface.position, uv), p.surface, p.facing, *p.material,
                  p.colour, p.direction);
}

// Returns the angular diameter of the light source as seen from the surface, rad.
double extent_angle(const ExtentLit& p) {
    const Light& l = *p.light->light;
    const double distance = glm::length(p.light->position - p.surface.position);
    const double size = l.kind == Light::Kind::sphere
                            ? 2 * l.radius
                            : std::max(glm::length(p.light->edge_u), glm::length(p.light->edge_v));
    return 2 * std::atan2(size / 2, distance);
}

// Returns the radiance that a surface reflects from an area light without shadows, averaged over the light.
// The light is divided into smaller and smaller cells, until the mean no longer changes and each cell is
// narrower than the surface's highlight.
dvec3 unshadowed(const ExtentLit& p) {
    const double highlight = p.material->has_highlight() ? std::sqrt(p.material->shininess) : 0;
    const double needed = std::min(extent_angle(p) * highlight, static_cast<double>(LightMeans::most_cells));
    dvec3 before(0);
    for (int k = 2;; k *= 2) {
        dvec3 sum(0);
        for (int j = 0; j < k; ++j)
            for (int i = 0; i < k; ++i) sum += lit_at(p, cell_point(p.seed, k, i, j)).radiance;
        const dvec3 mean = sum / static_cast<double>(k * k);
        const bool settled =
            k > 2 && k >= needed && largest(glm::abs(mean - before) * p.throughput) < target_noise / 2;
        if (settled || k >= LightMeans::most_cells) return mean;
        before = mean;
    }
}

// Returns k, the number of cells along each side of an area light, which is divided into k x k cells. One
// shadow ray is sent to a random point of each cell. At the edge of a shadow, the occluder's outline crosses
// about k of the cells, and in each of them, chance decides whether the light counts. With radiance L of the
// unshadowed light, a cell adds L / k^2 or nothing, so the standard deviation of their sum is sqrt(k) (L / 2)
// / k^2. k is chosen so that this is `target_noise`.
int cells_for(const ExtentLit& p, const dvec3& radiance) {
    const double bright = largest(radiance * p.throughput);
    const double k = std::ceil(std::pow(bright / (2 * target_noise), 2.0 / 3));
    return static_cast<int>(
        std::clamp(k, static_cast<double>(fewest_cells), static_cast<double>(LightMeans::most_cells)));
}

void send(const ExtentLit& p, const Lit& lit, RayBatch& rays) {
    rays.add(lit.origin, lit.segment, lit.reach, p.key);
}

}  // namespace

void LightMeans::average(std::vector<ExtentLit>& points, RayBatch& rays, std::uint64_t& shadow_rays) const {
    struct Penumbra {
        std::size_t point;
        int cells;
    };
    thread_local std::vector<Penumbra> penumbrae;
    thread_local std::vector<std::pair<std::size_t, dvec3>> shaded;  // point and radiance of every ray
    penumbrae.clear();
    shaded.clear();
    rays.clear(true);
    for (std::size_t i = 0; i < points.size(); ++i) {
        ExtentLit& p = points[i];
        p.radiance = p.steady = unshadowed(p);
        if (p.radiance == dvec3(0) || !p.light->light->casts_shadows) continue;
        for (int k = 0; k < first_points; ++k) {
            const Lit lit = lit_at(p, first_point(*p.light, p.seed, k));
            if (lit.radiance == dvec3(0)) continue;
            send(p, lit, rays);
            shaded.emplace_back(i, lit.radiance);
        }
    }
    if (!shaded.empty()) scene_.occlude(rays);
    for (std::size_t first = 0; first < shaded.size();) {
        ExtentLit& p = points[shaded[first].first];
        dvec3 least(1), most(0);
        std::size_t end = first;
        for (; end < shaded.size() && shaded[end].first == shaded[first].first; ++end) {
            least = glm::min(least, rays.transmittance[end]);
            most = glm::max(most, rays.transmittance[end]);
        }
        if (largest(most - least) < same_transmittance) {
            p.radiance *= least;
            p.steady *= least;
        } else {
            penumbrae.push_back({shaded[first].first, cells_for(p, p.radiance)});
            p.steady *= 0.5;
        }
        first = end;
    }
    shadow_rays += shaded.size();

    rays.clear(true);
    shaded.clear();
    for (const Penumbra& q : penumbrae) {
        ExtentLit& p = points[q.point];
        p.radiance = dvec3(0);
        for (int j = 0; j < q.cells; ++j) {
            for (int i = 0; i < q.cells; ++i) {
                const Lit lit = lit_at(p, cell_point(mix64(p.seed), q.cells, i, j));
                if (lit.radiance == dvec3(0)) continue;
                send(p, lit, rays);
                shaded.emplace_back(q.point, lit.radiance / static_cast<double>(q.cells * q.cells));
            }
        }
    }
    if (!shaded.empty()) scene_.occlude(rays);
    for (std::size_t k = 0; k < shaded.size(); ++k)
        points[shaded[k].first].radiance += shaded[k].second * rays.transmittance[k];
    shadow_rays += shaded.size();
}

}  // namespace postlens
