// One point's light as it fills the pupil: rays in rings that end at its very edge.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "lens/aperture_response.h"
#include "lens/prescription/lens_view.h"
#include "lens/response_grid.h"

namespace postlens {

/// Nodes by ring, from the middle of what passes to its edge, and spoke; of a point on the +y axis, so that
/// those with x < 0 are the mirror images. Between its nodes everything is taken to be linear.
struct PupilFan {
    static constexpr std::size_t rings = 12;
    static constexpr std::size_t spokes = 48;  ///< steps over half a turn, from +y to -y
    /// Rings stand closer towards the edge, where aberrations grow fastest.
    [[nodiscard]] static double ring_radius(std::size_t ring) {
        return std::pow(static_cast<double>(ring) / rings, 0.6);
    }
    struct Node {
        glm::dvec2 pupil_m{0};  ///< on the plane of the pinhole
        glm::dvec2 landing{0};  ///< tangent of the pixel it lands on, from that of the point
        double light = 0;       ///< per area of the plane
    };
    std::array<Node, (rings + 1) * (spokes + 1)> nodes;

    [[nodiscard]] Node& at(std::size_t ring, std::size_t spoke) { return nodes[ring * (spokes + 1) + spoke]; }
    [[nodiscard]] const Node& at(std::size_t ring, std::size_t spoke) const {
        return nodes[ring * (spokes + 1) + spoke];
    }
};

/// Of a point of inverse depth 1/z' (zero and below allowed: light that converges) towards the tangent
/// >= 0. `near_m`: where to look for the light first, then where its middle is. False, `out` untouched, where
/// none gets through.
[[nodiscard]] bool trace_fan(const LensView& view, double inverse_depth_per_m, double tangent,
                             glm::dvec2& near_m, PupilFan& out);

/// Where a fan's response lies on the raster.
struct FanImage {
    double gain_px = 1;  ///< px per tangent
    glm::dmat2 further_px_m{
        0};                   ///< added to a ray's landing per metre of the pupil: what mirrors and glass do
    glm::dvec2 axis{0, 1};    ///< unit vector of the raster from the picture's middle to the point
    glm::dvec2 centre_px{0};  ///< the point, relative to the anchor
};

/// No light lies farther from the point, px.
[[nodiscard]] double fan_reach_px(const PupilFan& fan, const FanImage& image);

/// The response on the pixel grid: triangles between nodes, each with its light spread evenly, fewer of them
/// where it is small. Values add up to 1 but for what lies beyond `window`.
[[nodiscard]] ResponseGrid fan_response(const PupilFan& fan, const FanImage& image,
                                        const PixelWindow& window);

}  // namespace postlens
