#include "tracer/recording/bright_images.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/object_pose.h"
#include "scene/shape_bounds.h"
#include "tracer/recording/small_things.h"
#include "tracer/shading/shading.h"

namespace postlens {
namespace {

using glm::dmat2;
using glm::dvec2;
using glm::dvec3;

/// The space between four rays: those that arrive, after the same reflections and refractions, from the
/// corners of a quadtree cell. A bright object in this space may be visible in the cell, in a mirror or in
/// glass.
struct Beam {
    explicit Beam(const std::array<const Arrival*, 4>& at) {
        for (std::size_t k = 0; k < 4; ++k) {
            from[k] = dvec3(at[k]->from);
            direction[k] = dvec3(at[k]->direction);
            origin += from[k] / 4.0;
            axis += direction[k] / 4.0;
            length = std::max(length, static_cast<double>(at[k]->length));
            throughput = std::max(throughput, static_cast<double>(at[k]->throughput));
        }
        axis = glm::normalize(axis);
        const dvec3 other = std::abs(axis.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
        right = glm::normalize(glm::cross(axis, other));
        down = glm::cross(axis, right);
        for (std::size_t k = 0; k < 4; ++k) {
            radius = std::max(radius, glm::length(from[k] - origin));
            spread = std::max(spread, glm::length(direction[k] - axis));
        }
    }
    /// Returns false only if no ray of the beam can touch the sphere before it hits a surface.
    [[nodiscard]] bool may_touch(const dvec3& centre, double of_radius) const {
        const dvec3 there = centre - origin;
        const double along = glm::dot(there, axis);
        if (along + of_radius < -radius || along - of_radius > length + radius) return false;
        const double reach = radius + spread * (std::abs(along) + of_radius) + of_radius;
        return glm::dot(there, there) - along * along <= reach * reach;
    }
    /// Returns the vector, m, from `point` to the nearest point of ray k, as components along `right` and
    /// `down`.
    [[nodiscard]] dvec2 past(const dvec3& point, std::size_t k) const {
        const dvec3 there = from[k] - point;
        const dvec3 nearest = there - glm::dot(there, direction[k]) * direction[k];
        return {glm::dot(nearest, right), glm::dot(nearest, down)};
    }

    std::array<dvec3, 4> from{}, direction{};
    dvec3 origin{0}, axis{0}, right{0}, down{0};
    double length = 0, throughput = 0;
    double radius = 0, spread = 0;  // greatest deviation of an origin, m, and of a direction
};

/// Radiance (that of the sRGB value 1/8) below which images in mirrors and glass are ignored.
constexpr double dimmest = 0.0144;

}  // namespace

BrightImages::BrightImages(const Scene& scene, double time_s, double most_cells) {
    if (!has_deeper_nodes(scene)) return;
    double mirrors = 0;
    for (const Object& o : scene.objects) {
        const Material& m = scene.materials[o.material];
        if (m.reflects() || m.transmission != dvec3(0)) ++mirrors;
        const double brightness = largest(m.emission);
        if (!(brightness > 1) || std::holds_alternative<Plane>(o.shape)) continue;
        const Bounds b = shape_bounds(o.shape, world_at(o, time_s));
        if (b.empty()) continue;
        const dvec3 half = (b.max - b.min) / 2.0;
        std::array<double, 3> sizes{half.x, half.y, half.z};
        std::sort(sizes.begin(), sizes.end());
        if (!(sizes[1] > 0 && sizes[2] <= 4 * sizes[1])) continue;  // long objects are not compact
        spheres_.push_back({(b.min + b.max) / 2.0, sizes[1], brightness});
    }
    // Largest number of bright objects whose images in mirrors and glass together need at most `most_cells`
    // quadtree cells. Each object is assumed to appear twice in every mirror or glass object.
    const double most = most_cells / (cells_of_image * 2 * std::max(mirrors, 1.0));
    // If there are more, only the objects that emit the most light are kept.
    if (static_cast<double>(spheres_.size()) > most) {
        std::stable_sort(spheres_.begin(), spheres_.end(), [](const Sphere& a, const Sphere& b) {
            return a.brightness * a.radius * a.radius > b.brightness * b.radius * b.radius;
        });
        spheres_.resize(static_cast<std::size_t>(most));
    }
    if (!spheres_.empty()) add_group(0, static_cast<std::uint32_t>(spheres_.size()));
}

void BrightImages::add_group(std::uint32_t first, std::uint32_t last) {
    Bounds all;
    for (std::uint32_t i = first; i < last; ++i) {
        all.add(spheres_[i].centre - dvec3(spheres_[i].radius));
        all.add(spheres_[i].centre + dvec3(spheres_[i].radius));
    }
    const std::size_t at = groups_.size();
    groups_.push_back({(all.min + all.max) / 2.0, glm::length(all.max - all.min) / 2, first, last, 0});
    groups_[at].after = static_cast<std::uint32_t>(groups_.size());
    if (last - first <= few) return;
    const dvec3 extent = all.max - all.min;
    const int axis = extent.x >= std::max(extent.y, extent.z) ? 0 : (extent.y >= extent.z ? 1 : 2);
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(spheres_.begin() + first, spheres_.begin() + middle, spheres_.begin() + last,
                     [axis](const Sphere& a, const Sphere& b) { return a.centre[axis] < b.centre[axis]; });
    add_group(first, middle);
    add_group(middle, last);
    groups_[at].after = static_cast<std::uint32_t>(groups_.size());
}

WantedCells BrightImages::wanted(const std::array<const Arrival*, 4>& at, double size_px) const {
    WantedCells out{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    if (groups_.empty()) return out;
    const Beam beam(at);
    const auto look_at = [&](const Sphere& s) {
        if (s.brightness * beam.throughput <= dimmest || !beam.may_touch(s.centre, s.radius)) return;
        const std::array<dvec2, 4> past{beam.past(s.centre, 0), beam.past(s.centre, 1),
                                        beam.past(s.centre, 2), beam.past(s.centre, 3)};
        const dvec2 middle = (past[0] + past[1] + past[2] + past[3]) / 4.0;
        const dmat2 by_cell((past[1] - past[0] + past[3] - past[2]) / 2.0,
                            (past[2] - past[0] + past[3] - past[1]) / 2.0);
        const double determinant = glm::determinant(by_cell);
        if (determinant == 0) return;
        const dmat2 cell_by = glm::inverse(by_cell);
        // `image` is the position of the centre of the bright sphere's image in a mirror or in glass,
        // relative to the centre of the quadtree cell. `reach` holds the image's half-widths. Both are in
        // cell widths.
        const dvec2 image = -(cell_by * middle);
        const dvec2 reach(s.radius * std::hypot(cell_by[0][0], cell_by[1][0]),
                          s.radius * std::hypot(cell_by[0][1], cell_by[1][1]));
        // Tests whether the image of the bright sphere `s` in a mirror or in glass overlaps the quadtree
        // cell. The half-widths of the cell (0.5) and of the image are enlarged by a tenth, because the
        // position is computed by a linear approximation.
        constexpr double border = 0.55;
        if (!(std::abs(image.x) <= border + 1.1 * reach.x && std::abs(image.y) <= border + 1.1 * reach.y))
            return;
        // A mirror or glass shows the bright sphere `s` approximately as an ellipse. `squares` is half the
        // sum of its squared half axes, and `area` is their product. The half axes are the singular values of
        // s.radius * cell_by, where `cell_by` converts metres at the sphere to cell widths.
        const double squares = s.radius * s.radius *
                               (glm::dot(cell_by[0], cell_by[0]) + glm::dot(cell_by[1], cell_by[1])) / 2,
                     area = s.radius * s.radius / std::abs(determinant);
        const double root = std::sqrt(std::max(0.0, squares * squares - area * area));
        // The smaller half axis of the image of the bright sphere, in widths of the quadtree cell.
        const double half = area / std::sqrt(squares + root);
        const double width_px = 2 * half * size_px;
        constexpr double finest = 1.0 / (1 << most_levels);
        if (!(width_px <= SmallThings::widest_px)) return;
        out.find_px = std::min(out.find_px, std::max(width_px * SmallThings::find_share, finest));
        out.outline_px = std::min(out.outline_px, std::max(width_px * SmallThings::bright_share, finest));
    };
    for (std::size_t g = 0; g < groups_.size();) {
        const Group& group = groups_[g];
        if (!beam.may_touch(group.centre, group.radius)) {
            g = group.after;
            continue;
        }
        if (group.last - group.first <= few) {
            for (std::uint32_t i = group.first; i < group.last; ++i) look_at(spheres_[i]);
        }
        ++g;
    }
    return out;
}

}  // namespace postlens
