// Decides which hidden surfaces a lens can see. The centre of the lens does not see them, but points near its
// rim see a strip of them behind an edge.
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

/// Decides from depths whether some point of a lens may see a hidden surface. The inverse depth of a node is
/// half the trace of its matrix W; this is 1/z' for a surface that is seen directly. Between the centre and
/// the rim of a lens of radius R, the images of two surfaces move relative to each other by g R |1/z1 - 1/z2|
/// px, at any focus distance (g: film distance / pixel pitch). This displacement is the greatest width of the
/// strip of the farther surface that appears behind an edge of the nearer one.
class LensReach {
  public:
    /// Two surfaces are treated as one if their images at the rim of the lens are displaced relative to each
    /// other by less than this, px. The farther surface then appears beside an edge of the nearer one, but
    /// only in a strip of less than a quarter of a pixel, and only from lens points near the rim.
    static constexpr double same_place_px = 0.25;
    /// Margin, px, that is added to the width of the strip of a hidden surface. The position of an edge has
    /// an error of up to the diagonal of a pixel. In addition, the hidden surface is needed up to the far
    /// corners of the last pixel that shows it.
    static constexpr double margin_px = 2.5;
    /// A surface has an edge where the shift of its image, seen from the rim of the lens, changes by at least
    /// this much from pixel to pixel, px/px. A single plane reaches this change only if it is so steep (slope
    /// z' / (8 R)) that no lens point sees behind it.
    static constexpr double edge_slope = 0.125;
    /// Largest number of bounces after which hidden surfaces are recorded. After more bounces, they are
    /// numerous and faint.
    static constexpr int most_bounces = 2;

    /// Traces one ray per pixel of [x_begin, x_end) x [y_begin, y_end) from the pinhole to find depths and
    /// edges. Edges outside this window are not found. Requires `aperture_radius_m` > 0 and a perspective
    /// camera. `max_depth`: as in the trace that uses the result. Deterministic for any number of threads.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              int x_begin, int x_end, int y_begin, int y_end);

    /// The surfaces ("covers") that one ray has passed so far and that may hide the next one. All belong to
    /// the same view of the scene: the rays with the same path whose last bounce is at the same object.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty: hits of the eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0: none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        /// inverse depth at infinite distance on the ray, 1/m; after curved mirrors it is not 0
        double limit = 0;
    };
    /// True if some lens point may see a surface with the inverse depth `behind`, 1/m, that lies on the ray
    /// of `covers` behind all of them. The result may be true for a surface that no lens point sees. If it is
    /// false, no lens point sees the surface.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// True if some lens point may see a surface that lies on the ray of `covers`, at any distance behind all
    /// of them.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Returns half the trace of a node's matrix W, 1/m. It is the mean inverse depth of the node's image
    /// along the two raster axes.
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
    /// Displacement between the images of two surfaces at the rim of the lens, per difference of their
    /// inverse depths, px m. It is the lens radius, m, divided by the tangent of the angle between
    /// neighbouring pixels.
    double px_per_inverse_m_;
    std::map<View, MinMaxPyramid> views_;
};

}  // namespace postlens
