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
    /// Margin, px, around the part of a hidden surface that the lens sees past an edge:
    /// - The position of the edge is known only up to the diagonal of a pixel.
    /// - The corners of all pixels that show the part must be included.
    static constexpr double margin_px = 2.5;
    /// Least shift between two surfaces' images over the lens, px per px of distance, that counts as an edge.
    /// A plane has this slope only if it is so oblique that no lens point sees behind it.
    static constexpr double edge_slope = 0.125;
    /// Hidden surfaces are recorded after at most this number of bounces. Later ones are numerous and faint.
    static constexpr int most_bounces = 2;

    /// Finds depths and edges by one ray from the pinhole per pixel of [x_begin, x_end) x [y_begin, y_end).
    /// Requires a perspective camera, `aperture_radius_m` > 0, and the `max_depth` of the trace.
    /// Surfaces whose images shift by less than `same_place_px` relative to each other count as one.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              double same_place_px, int x_begin, int x_end, int y_begin, int y_end);

    /// The surfaces that one ray has passed so far, which may hide the next one from the lens.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty for an eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0 if none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        /// Inverse depth, 1/m, at which an infinitely distant point on the ray appears.
        /// It is 0 for an eye ray, but not after a curved mirror.
        double limit = 0;
    };
    /// Returns true if some lens point may see a surface of inverse depth `behind`, 1/m, past the surfaces
    /// `covers` in front of it on the same ray. If false, certainly no lens point sees it.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// Returns true if some lens point may see a surface at any depth behind all `covers`, on the same ray.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Returns a recorded point's inverse depth, 1/m: the mean of the diagonal of W, one value per raster
    /// axis.
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
    /// Converts a difference of inverse depths, 1/m, to the shift, px, of two images against each other
    /// from the lens centre to its rim: lens radius, m, divided by the camera's tangent per pixel.
    double px_per_inverse_m_;
    std::map<View, MinMaxPyramid> views_;
};

}  // namespace postlens
