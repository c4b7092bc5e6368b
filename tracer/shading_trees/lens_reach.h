// Decides which hidden surfaces a lens can see. The lens's centre does not see them, but points near its rim
// see a strip of them behind an edge.
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
/// half the trace of W, which is 1/z' for surfaces seen directly. From the rim of a lens of radius R, two
/// surfaces are displaced against each other by gain R |1/z1 - 1/z2| px at any focus distance. This is the
/// greatest width of the strip of the farther surface that appears behind an edge of the nearer one.
class LensReach {
  public:
    /// Two surfaces whose images at the lens's rim are displaced against each other by less than this, px,
    /// are treated as one surface. A pixel is the mean of at least four corners, in which a narrower strip is
    /// not visible.
    static constexpr double same_place_px = 0.25;
    /// Margin, px, that is added to the width of the strip of a hidden surface that the lens sees. The
    /// position of an edge has an error of up to the diagonal of a pixel, and the hidden surface is needed up
    /// to the far corners of the last pixel that shows it.
    static constexpr double margin_px = 2.5;
    /// Least change of a surface's displacement at the lens's rim per pixel, px/px, that counts as an edge. A
    /// single plane reaches it only where it is so steep that no lens point looks behind it (slope z' / (8
    /// R)).
    static constexpr double edge_slope = 0.125;
    /// Hidden surfaces are not recorded after more bounces than this, because such surfaces are numerous and
    /// faint.
    static constexpr int most_bounces = 2;

    /// Traces one ray per pixel of [x_begin, x_end) x [y_begin, y_end) from the pinhole to find depths and
    /// edges; outside this window no edge is known. Requires `aperture_radius_m` > 0 and a perspective
    /// camera. `max_depth`: as in the trace that uses it. Deterministic for any number of threads.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              int x_begin, int x_end, int y_begin, int y_end);

    /// The surfaces ("covers") that one ray has passed so far and that may hide the next one. They belong to
    /// one view of the scene, which consists of all rays with the same path whose last bounce is at the same
    /// object.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty: hits of the eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0: none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        double limit = 0;  ///< inverse depth at infinite distance on the ray; not 0 after curved mirrors
    };
    /// True if some lens point may see a surface that lies on the ray of `covers`, behind all of these
    /// surfaces, and has the inverse depth `behind`, 1/m. The result may be true although no lens point sees
    /// that surface, but it is never false if one does.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// True if some lens point may see a surface that lies on the ray of `covers` at any distance behind all
    /// of these surfaces.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Half the trace of a node's matrix W, 1/m: the mean inverse depth of the node's image along the two
    /// raster axes.
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
    double px_per_inverse_m_;  ///< gain R: displacement at the rim per difference of inverse depths, px m
    std::map<View, MinMaxPyramid> views_;
};

}  // namespace postlens
