#include "lens/traced/lens_section.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int outline_points = 48;

// Returns a surface's profile as points (z, y), from y = -radius to y = radius.
std::vector<dvec2> outline(const Surface& s, double z, double radius) {
    std::vector<dvec2> out;
    for (int i = 0; i <= outline_points; ++i) {
        const double y = radius * (2.0 * i / outline_points - 1);
        const double sag = s.sag_mm(std::abs(y));
        if (std::isfinite(sag)) out.emplace_back(z + sag, y);
    }
    return out;
}

void add_rays(const TracedLens& traced, double depth_m, std::size_t field, double tangent, int count,
              LensSection& section, std::vector<double>& reach) {
    const LensStack& stack = traced.stack();
    PupilMesh mesh;
    if (!traced.impulse(depth_m, {0, tangent}, 64, mesh)) return;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t k = 0; k < mesh.passes.size(); ++k) {
        if (mesh.passes[k] == 0) continue;
        low = std::min(low, mesh.pupil_mm[k].y);
        high = std::max(high, mesh.pupil_mm[k].y);
    }
    std::vector<dvec3> hits(stack.size());
    for (int i = 0; i < count; ++i) {
        const double share = count == 1 ? 0.5 : static_cast<double>(i) / (count - 1);
        LensRay ray = traced.object_ray(depth_m, {0, tangent}, {0, low + (high - low) * share});
        const LensRay before = ray;
        if (!stack.forward(ray, Apertures::respected, hits).passes()) continue;
        LensSection::RayLine line{field, {}};
        line.points.emplace_back(section.front_z_mm, before.at_z(section.front_z_mm).y);
        for (std::size_t s = 0; s < hits.size(); ++s) {
            line.points.emplace_back(hits[s].z, hits[s].y);
            reach[s] = std::max(reach[s], std::abs(hits[s].y));
        }
        line.points.emplace_back(section.film_z_mm, traced.on_film(ray).y);
        section.rays.push_back(std::move(line));
    }
}

}  // namespace

LensSection lens_section(const Prescription& lens, const TracedLens& traced, double depth_m,
                         const std::vector<double>& fields, int rays) {
    const LensStack& stack = traced.stack();
    LensSection out;
    out.film_z_mm = stack.last_vertex_z_mm() + traced.film_distance_mm();
    const double length = std::max(out.film_z_mm, 1e-3);
    const double pupil = traced.first_order().entrance_pupil_diameter_mm;
    out.front_z_mm = std::min(0.0, lens.surfaces.front().sag_mm(0.5 * pupil)) - 0.2 * length;
    if (!std::isfinite(out.front_z_mm)) out.front_z_mm = -0.2 * length;
    std::vector<double> reach(stack.size(), 0);
    for (std::size_t i = 0; i < fields.size(); ++i) add_rays(traced, depth_m, i, fields[i], rays, out, reach);
    const auto radius_of = [&](std::size_t i) {
        const double clear = lens.surfaces[i].clear_radius_mm;
        return std::isfinite(clear) && !lens.surfaces[i].is_stop ? clear
                                                                 : std::max(1.03 * reach[i], 0.05 * pupil);
    };
    for (std::size_t i = 0; i < stack.size(); ++i) {
        const Surface& s = lens.surfaces[i];
        const double z = stack.vertex_z_mm(i);
        if (s.is_stop) {
            const double opening = stack.stop_radius_mm(),
                         outer = std::max(radius_of(i), opening * 1.02) + 0.2 * opening;
            out.stop.push_back({{z, opening}, {z, outer}});
            out.stop.push_back({{z, -opening}, {z, -outer}});
            out.height_mm = std::max(out.height_mm, outer);
        }
        if (i + 1 < stack.size() && !s.glass.is_air()) {
            // Draws both surfaces of a lens element up to the larger of their radii, as on real lenses.
            auto shape = outline(s, z, radius_of(i));
            auto back = outline(lens.surfaces[i + 1], stack.vertex_z_mm(i + 1), radius_of(i + 1));
            const double rim = std::max(radius_of(i), radius_of(i + 1));
            out.height_mm = std::max(out.height_mm, rim);
            if (shape.empty() || back.empty()) continue;
            for (auto* side : {&shape, &back}) {
                const dvec2 first = side->front(), last = side->back();
                side->insert(side->begin(), dvec2(first.x, -rim));
                side->push_back(dvec2(last.x, rim));
            }
            shape.insert(shape.end(), back.rbegin(), back.rend());
            out.glass.push_back(std::move(shape));
        } else if (!s.is_stop && (i == 0 || lens.surfaces[i - 1].glass.is_air())) {
            out.planes.push_back(outline(s, z, radius_of(i)));
        }
    }
    for (const auto& ray : out.rays) {
        for (const dvec2& p : ray.points) out.height_mm = std::max(out.height_mm, std::abs(p.y));
    }
    return out;
}

}  // namespace postlens
