// What points of a lens see that its centre does not: how far behind the edges of what stands before them
// hidden surfaces come to be seen.
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

/// Inverse depths are 1/z' of what is seen directly; of what mirrors and glass show they are half the trace
/// of W. Over a lens of radius R two surfaces part by gain R |1/z1 - 1/z2| px, wherever it is focused, so the
/// farther one is seen behind an edge of the nearer one for so many px at most.
class LensReach {
  public:
    /// Over a lens's radius; less shows as nothing in a pixel's mean of at least four corners.
    static constexpr double same_place_px = 0.25;
    /// Edges are known to a pixel's diagonal, and what comes to light is wanted up to the far corners of the
    /// last pixel that it is seen in.
    static constexpr double margin_px = 2.5;
    /// An edge is where something lies behind its neighbours by so many px over the lens's radius, per px of
    /// distance. A plane would have to lean so that its tangent is z' / (8 R): no lens looks behind that.
    static constexpr double edge_slope = 0.125;
    /// What deeper chains show is not peeled: their nodes are faint, and there are many kinds.
    static constexpr int most_bounces = 2;

    /// Looks at the picture from the pinhole, one ray a pixel, around whole coordinates [x_begin, x_end) x
    /// [y_begin, y_end); outside nothing is known. `aperture_radius_m` > 0, perspective cameras only.
    /// `max_depth` as of the trace that asks. The same for any number of threads.
    LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m, int max_depth,
              int x_begin, int x_end, int y_begin, int y_end);

    /// What one ray has met so far, all of it in one picture: the surfaces at the ends of rays with the same
    /// path that come from the same object.
    struct Covers {
        glm::dvec2 at{0};          ///< raster, px
        NodePath path;             ///< 0: what the eye ray meets
        std::uint32_t parent = 0;  ///< id of the object where the last bounce was; 0 for none
        double nearest = 0;        ///< inverse depth of the first, 1/m
        double farthest = 0;       ///< of the one farthest away
        double limit = 0;  ///< of what lies on the ray infinitely far away; not 0 behind curved mirrors
    };
    /// Whether some point of the lens may see what lies on the ray behind all the covers at inverse depth
    /// `behind`. Errs on the side of yes.
    [[nodiscard]] bool may_see(const Covers& covers, double behind) const;
    /// The same of anything at all that is farther away.
    [[nodiscard]] bool may_see_past(const Covers& covers) const;

    [[nodiscard]] double aperture_radius_m() const { return aperture_radius_m_; }

    /// Half the trace of W, 1/m.
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
    double px_per_inverse_m_;  ///< gain R: how far a lens's rim parts surfaces, px m
    std::map<View, MinMaxPyramid> views_;
};

}  // namespace postlens
