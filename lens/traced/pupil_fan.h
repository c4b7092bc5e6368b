// A fan: the rays of one object point through the pupil, arranged in rings.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "lens/aperture_response.h"
#include "lens/response_grid.h"
#include "lens/traced/lens_view.h"

namespace postlens {

/// A fan: the traced rays of one object point on the +y axis through the lens. The points at which the rays
/// cross the pupil form a mesh of rings and spokes. The mesh extends from the centre to the edge of the area
/// through which light passes.
struct PupilFan {
    static constexpr std::size_t rings = 12;
    static constexpr std::size_t spokes = 48;  ///< directions over half a turn of the pupil, from +y to -y
    /// Rings of rays are closer together towards the pupil's edge, where aberrations grow fastest.
    [[nodiscard]] static double ring_radius(std::size_t ring) {
        return std::pow(static_cast<double>(ring) / rings, 0.6);
    }
    struct Node {
        glm::dvec2 pupil_m{0};  ///< on the plane of the pinhole
        glm::dvec2 landing{0};  ///< tangent of the landing pixel minus that of the object point
        double light = 0;       ///< light per area of the plane of the pinhole
    };
    /// Rays through the half of the pupil with x >= 0, ring by ring. The rays through the other half are
    /// their mirror images, because the object point lies on the y axis. Therefore, they are not stored.
    std::array<Node, (rings + 1) * (spokes + 1)> nodes;

    [[nodiscard]] Node& at(std::size_t ring, std::size_t spoke) { return nodes[ring * (spokes + 1) + spoke]; }
    [[nodiscard]] const Node& at(std::size_t ring, std::size_t spoke) const {
        return nodes[ring * (spokes + 1) + spoke];
    }
};

/// Traces the fan of one object point, which is the bundle of rays from this point that pass the lens.
/// Returns false if no light passes.
/// - inverse_depth_per_m: inverse depth of the object point; 0 at infinity; negative if the rays converge
///   towards a point behind the lens
/// - tangent: tangent of the object point's angle from the axis, >= 0
/// - near_m: point of the pupil, in m, at which the search for passing rays begins; the function sets it to
///   the centre of the region of passing rays
/// - out: receives the fan; unchanged if no light passes
[[nodiscard]] bool trace_fan(const LensView& view, double inverse_depth_per_m, double tangent,
                             glm::dvec2& near_m, PupilFan& out);

/// Position and scale of a fan's impulse response on the raster.
struct FanImage {
    double gain_px = 1;  ///< px per tangent
    glm::dmat2 further_px_m{
        0};                   ///< shift of a ray's landing point by mirrors and glass, per metre on the pupil
    glm::dvec2 axis{0, 1};    ///< unit vector on the raster from the image centre to the object point
    glm::dvec2 centre_px{0};  ///< pinhole image of the object point, px from the response's raster position
};

/// Returns the radius, in px, of an object point's impulse response. `fan` holds the rays from this point
/// through the lens. The radius is the largest distance on the raster between the point's pinhole image and
/// the landing point of one of these rays.
[[nodiscard]] double fan_reach_px(const PupilFan& fan, const FanImage& image);

/// Computes the impulse response of an object point on the pixel grid, within `window`. The rays of `fan`
/// form a mesh in the pupil. The light through each cell of this mesh is spread uniformly over the area
/// between the landing points of the cell's rays. The values add up to 1, except for light that falls outside
/// `window`.
[[nodiscard]] ResponseGrid fan_response(const PupilFan& fan, const FanImage& image,
                                        const PixelWindow& window);

}  // namespace postlens
