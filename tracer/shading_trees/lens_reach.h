// Decides which hidden surfaces a lens can see. The centre of the lens does not see these surfaces, but
// points near its rim see a strip of them behind an edge.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/min_max_pyramid.h"

namespace postlens {

/// Decides from depths whether some point of a lens may see a hidden surface. Between the centre and the rim
/// of a lens, the images of two surfaces shift relative to each other by g R |1/z1 - 1/z2| px, at any focus
/// distance. Here g is the film distance divided by the pixel pitch, and R is the radius of the lens. 1/z1
/// and 1/z2 are the inverse depths of the surfaces. The farther surface appears behind an edge of the nearer
/// one as a strip that is at most as wide as this shift.
///
/// The inverse depth of a node is half the trace of W, the matrix that describes how the node's image moves
/// with the lens point. For a surface that is seen directly, this is 1/z'.
class LensReach {
  public:
    /// Two surfaces are treated as one if the relative shift of their images at the rim of the lens is below
    /// this value, px. The strip of the farther surface that appears beside an edge is then narrower than a
    /// quarter of a pixel.
    static constexpr double same_place_px = 0.25;
    /// Margin, px, that is added to the width of the strip of a hidden surface. The position of an edge is
    /// known only up to the diagonal of a pixel. In addition, the strip must reach the far corners of the
    /// last pixel that shows the hidden surface.
    static constexpr double margin_px = 2.5;
    /// A surface has an edge where the shift of its image at the rim of the lens changes by at least this
    /// value from pixel to pixel, px/px. In a single plane, this happens only if the plane is so steep (slope
    /// z' / (8 R)) that no lens point sees behind it.
    static constexpr double edge_slope = 0.125;
    /// Largest number of bounces after which hidden surfaces are recorded. After more bounces, hidden
    /// surfaces are numerous and faint.
    static constexpr int most_bounces = 2;

    /// Finds depths and edges with one ray from the pinhole per pixel of [x_begin, x_end) x [y_begin, y_end).
    /// Edges outside this window are not found. Requires `aperture_radius_m` > 0 and a perspective camera.
    /// `max_depth` must be that of the trace that uses the result. The result does not depend on the number
    /// of threads.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              int x_begin, int x_end, int y_begin, int y_end);

    /// The surfaces ("covers") that one ray has passed so far and that may hide the next surface. All covers
    /// belong to the same view of the scene. A view consists of the rays that have the same path and bounced
    /// last at the same object.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty for an eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0 if none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        /// Inverse depth at infinite distance on the ray, 1/m. It is not 0 after curved mirrors.
        double limit = 0;
    };
    /// Returns whether some lens point may see a surface behind all `covers`, on the same ray. `behind` is
    /// the inverse depth of the surface, 1/m. If the result is false, no lens point sees the surface. If it
    /// is true, the surface may nevertheless be invisible from the lens.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// Like may_see, but for a surface at any distance behind all `covers`.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Returns the mean inverse depth of a node's image along the two raster axes, 1/m. It is half the trace
    /// of the node's matrix W.
    [[nodiscard]] static double inverse_depth(const Mat2& w) {
        return (static_cast<double>(w.xx) + static_cast<double>(w.yy)) / 2;
    }

  private:
    using View = std::pair<std::uint32_t, std::uint32_t>;  ///< path, parent
    struct Seen {
        View view;
        int x, y;
        float inverse_depth;
    };
    using Search = bool (MinMaxPyramid::*)(const MinMaxPyramid::Cone&, MinMaxPyramid::Hint&) const;
    [[nodiscard]] bool looks_behind(const Covers& covers, double behind, Search search) const;
    static void add_chains(std::span<const Record> records, int x, int y, std::vector<Seen>& out);
    void add_view(const View& view, std::span<const Seen> seen);

    double aperture_radius_m_;
    /// Relative shift of the images of two surfaces at the rim of the lens, per difference of their inverse
    /// depths, px m. It is the lens radius, m, divided by the tangent of the angle between neighbouring
    /// pixels.
    double px_per_inverse_m_;
    std::map<View, MinMaxPyramid> views_;
};

}  // namespace postlens
