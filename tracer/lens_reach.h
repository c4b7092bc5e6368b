// Decides which hidden surfaces a lens can see. The lens's centre does not see them, but points towards its
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
#include "tracer/min_max_pyramid.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// Decides from depths whether some point of a lens may see a hidden surface. The inverse depth of a node is
/// half the trace of W, which is 1/z' for surfaces seen directly. From the rim of a lens of radius R, two
/// surfaces are displaced against each other by gain R |1/z1 - 1/z2| px at any focus distance. This is the
/// greatest width of the strip of the farther surface that appears behind an edge of the nearer one.
class LensReach {
  public:
    /// Surfaces displaced by less than this are treated as one, px. A pixel is the mean of at least four
    /// corners, in which a narrower strip is not visible.
    static constexpr double same_place_px = 0.25;
    /// Margin that is added to the width of the strip, px. The position of an edge is known to within the
    /// diagonal of a pixel, and the hidden surface is needed up to the far corners of the last pixel that
    /// shows it.
    static constexpr double margin_px = 2.5;
    /// Least change of displacement per pixel that counts as an edge, px/px. A single plane reaches it only
    /// where it is so steep that no lens point looks behind it (slope z' / (8 R)).
    static constexpr double edge_slope = 0.125;
    /// No hidden surfaces are recorded after more bounces than this: such nodes are numerous and faint.
    static constexpr int most_bounces = 2;

    /// Traces one ray per pixel of [x_begin, x_end) x [y_begin, y_end) from the pinhole to find depths and
    /// edges; outside this window no edge is known. Requires `aperture_radius_m` > 0 and a perspective
    /// camera. `max_depth`: as in the trace that uses it. Deterministic for any number of threads.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              int x_begin, int x_end, int y_begin, int y_end);

    /// The surfaces that one ray has passed so far. They belong to one view of the scene: rays with the same
    /// path whose last bounce is at the same object.
    struct Covers {
        glm::dvec2 at{0};          ///< raster position of the eye ray, px
        NodePath path;             ///< path of these surfaces; empty: hits of the eye ray
        std::uint32_t parent = 0;  ///< id of the object of the last bounce; 0: none
        double nearest = 0;        ///< inverse depth of the first surface, 1/m
        double farthest = 0;       ///< inverse depth of the farthest surface, 1/m
        double limit = 0;  ///< inverse depth at infinite distance on the ray; not 0 after curved mirrors
    };
    /// True if some lens point may see a surface on this ray, behind all covers, at inverse depth `behind`.
    /// The result may be true although no lens point sees it, but is never false if one does.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// True if some lens point may see a surface behind all covers at any greater distance.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Half the trace of W, 1/m: the mean of the two inverse depths of the image.
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
