// Decides which hidden surfaces a lens can see. From the centre of the lens, these surfaces are hidden. From
// other points of the lens, a narrow strip of them is visible beside the edge of the surface in front.
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

/// Decides from depths whether some point of a lens may see a hidden surface. If the lens point moves from
/// the centre of the lens to its outline, the images of two surfaces shift relative to each other. The lens
/// then sees a strip of the farther surface beside an edge of the nearer one. The strip is at most as wide as
/// the shift.
///
/// The shift is g R |1/z1 - 1/z2| px, at any focus distance. Here g is the film distance divided by the pixel
/// pitch, R is the radius of the lens, and 1/z1 and 1/z2 are the inverse depths of the surfaces.
///
/// The inverse depth of a node is half the trace of W, the matrix that describes how the node's image moves
/// with the lens point. For a surface that is seen directly, this is the reciprocal of its depth.
class LensReach {
  public:
    /// Margin, px, around the strip of a hidden surface that the lens sees. There are two reasons. The
    /// position of an edge is known only up to the diagonal of a pixel. The recorded strip must include the
    /// corners of all pixels that show it.
    static constexpr double margin_px = 2.5;
    /// An edge between two surfaces is assumed where, over the lens, their images shift relative to each
    /// other by at least this value, px, per px of their distance on the raster. Within a plane, the shift
    /// changes this much only if the plane is seen so obliquely that no lens point sees behind it.
    static constexpr double edge_slope = 0.125;
    /// Largest number of bounces after which hidden surfaces are recorded. After more bounces, hidden
    /// surfaces are numerous and faint.
    static constexpr int most_bounces = 2;

    /// Finds depths and edges with one ray from the pinhole per pixel of [x_begin, x_end) x [y_begin, y_end).
    /// Edges outside this window are not found. Requires `aperture_radius_m` > 0 and a perspective camera.
    /// `max_depth` must equal that of the trace. The result does not depend on the number of threads.
    ///
    /// Two surfaces are treated as one if, over the lens, their images shift by less than `same_place_px`,
    /// px, relative to each other. The strip of the farther surface that the lens sees past an edge is at
    /// most this wide.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              double same_place_px, int x_begin, int x_end, int y_begin, int y_end);

    /// The surfaces that one ray has passed so far ("covers"). They may hide the next surface on the ray.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty for an eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0 if none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        /// Inverse depth, 1/m, of the image of an infinitely distant point on the ray. It is 0 for an eye
        /// ray, but not after a curved mirror, which images the point at a finite depth.
        double limit = 0;
    };
    /// Returns whether some lens point may see a surface behind all `covers`, on the same ray. `behind` is
    /// the inverse depth of the surface, 1/m. If the result is false, no lens point sees the surface. If it
    /// is true, the surface may nevertheless be invisible from the lens.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// Returns whether some lens point may see a surface at any distance behind all `covers`, on the same
    /// ray.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Returns the inverse depth of a node, 1/m, as a mean over the two raster axes. It is half the trace of
    /// W, the matrix that describes how the node's image moves with the lens point.
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

    double aperture_radius_m_, same_place_px_;
    /// Factor that converts a difference of inverse depths, 1/m, to a shift, px. The shift is that of two
    /// surfaces' images relative to each other when the lens point moves from the centre of the lens to its
    /// outline. The factor is the lens radius, m, divided by the camera's tangent per pixel.
    double px_per_inverse_m_;
    std::map<View, MinMaxPyramid> views_;
};

}  // namespace postlens
