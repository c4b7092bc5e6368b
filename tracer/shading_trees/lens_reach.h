// Decides which hidden surfaces some point of the lens can see past the edge of the surface in front.
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

/// Decides from depths whether some point of a lens may see a surface that is hidden from its centre.
/// From the outline of the lens, the images of two surfaces are shifted relative to each other.
/// The lens sees a strip of the farther surface beside an edge, at most as wide as this shift.
///
/// The shift is g R |1/z1 - 1/z2| px, at any focus distance:
/// - g: film distance divided by pixel pitch
/// - R: radius of the lens, m
/// - 1/z1, 1/z2: inverse depths of the surfaces, 1/m
///
/// The inverse depth of a node is half the trace of W. For a surface seen directly, it is 1 / depth.
class LensReach {
  public:
    /// Margin, px. From some lens points, a hidden surface is visible past the edge of a nearer surface. In
    /// the pinhole image, it is therefore recorded within a certain distance from this edge. The margin is
    /// added to this distance, because the edge is known only with an accuracy of one pixel, and only whole
    /// pixels are recorded.
    static constexpr double margin_px = 2.5;
    /// Decides whether two pixels at the distance d, px, have a depth edge between them. When the lens point
    /// moves from the centre of the lens to its rim, the images of surfaces at different depths move apart.
    /// There is an edge between the pixels if their surfaces move apart by at least edge_slope * d. So a
    /// moderately inclined surface has no edges.
    static constexpr double edge_slope = 0.125;
    /// Hidden surfaces are recorded only in rays with at most this number of reflections and refractions.
    /// After more bounces, they are numerous and faint.
    static constexpr int most_bounces = 2;

    /// Finds the depths of the visible surfaces, to decide later what a lens may see past them. One ray from
    /// the lens centre is traced for each pixel of the columns x_begin to x_end - 1 and the rows y_begin to
    /// y_end - 1. The camera must be a perspective camera.
    /// - `aperture_radius_m`: radius of the lens; greater than 0
    /// - `max_depth`: largest number of surfaces on a path of reflections and refractions
    /// - `same_place_px`: two surfaces count as equally deep if their images move apart by less than this,
    ///   px, when the lens point moves from the centre of the lens to its rim
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              double same_place_px, int x_begin, int x_end, int y_begin, int y_end);

    /// Describes the surfaces that one ray has crossed so far: an eye ray, or a ray after reflections and
    /// refractions. From the lens centre, they hide everything behind them on this ray. From another lens
    /// point, hidden surfaces may be visible past them.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty for an eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0 if none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        /// Inverse depth, 1/m, at which an infinitely distant point on the ray appears to the lens. No
        /// surface behind the crossed ones appears farther away. The value is 0 for an eye ray. After a
        /// bounce at a curved mirror, it is not 0, because such a mirror shows even infinitely distant points
        /// at a finite depth.
        double limit = 0;
    };
    /// Returns true if some lens point may see a hidden surface on a ray. `behind` is the inverse depth, 1/m,
    /// of the hidden surface, and `covers` describes the surfaces in front of it on the same ray. If the
    /// result is false, certainly no lens point sees the hidden surface.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// Returns true if some lens point may see the infinitely distant background past the surfaces that
    /// `covers` describes. These are the surfaces in front of the background on a ray from the lens centre.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Returns the inverse depth, 1/m, at which a recorded point appears. The matrix `w` describes how the
    /// point's image moves when the lens point moves. If the point is seen directly, both diagonal entries of
    /// `w` are 1 / depth. In a curved mirror, the point appears at two different depths, for horizontal and
    /// for vertical lines. The mean of both entries is then used.
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
    using Peek = bool (MinMaxPyramid::*)(const MinMaxPyramid::Cone&, const MinMaxPyramid::Hint&) const;
    [[nodiscard]] bool looks_behind(const Covers& covers, double behind, Search search, Peek peek) const;
    static void add_chains(std::span<const Record> records, int x, int y, std::vector<Seen>& out);
    void add_view(const View& view, std::span<const Seen> seen);

    double aperture_radius_m_, same_place_px_;
    /// Converts the difference of two surfaces' inverse depths, 1/m, to their parallax, px, from lens centre
    /// to lens rim.
    double px_per_inverse_m_;
    std::map<View, MinMaxPyramid> views_;
    const MinMaxPyramid* eye_view_ = nullptr;  ///< the view of eye rays, which most searches need
};

}  // namespace postlens
