// Draws highlights that move during the exposure as continuous streaks. Each is blurred and added at many
// instants.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "reproject/patches/patches.h"
#include "reproject/raster_map.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

class HighlightMotion {
  public:
    /// Largest total area, in px^2, of the moving highlights of a surface (within 16 x 16 px) that are
    /// blurred into streaks. Larger ones already look like streaks without this.
    static constexpr float largest_px2 = 64;
    /// Highlights become streaks only if their radiance exceeds the limit for highlights by this. Dimmer ones
    /// already look smooth in the mean of the reprojected images.
    static constexpr float least_radiance = 3;

    /// Returns how an object moves from the recorded instant to the instant at which the fraction `u` (0 to
    /// 1) of the exposure has passed.
    using Map = std::function<RasterMap(std::uint32_t id, double u)>;
    /// - `moves`: whether an object moves on the raster
    /// - `map`: the motion of an object
    /// - `lens`: determines the size of the blur
    HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, PatchLens lens);

    /// Returns whether a surface moves and is seen directly. `key` identifies its object and the reflections
    /// through which it is seen.
    [[nodiscard]] bool moves(const SheetKey& key) const { return key.path.bits() == 0 && moves_(key.id); }
    /// Returns whether a moving highlight is blurred into a streak. `area_px2` is the area of all highlights
    /// of its surface (BrightSheet::area_px2).
    [[nodiscard]] static bool takes(const Highlight& light, float area_px2);
    /// A moving highlight at one instant of the exposure.
    struct Moment {
        Highlight light;   ///< as seen at the instant
        double u = 0;      ///< fraction of the exposure that has passed, 0 to 1; -1 if always present
        double share = 1;  ///< share of the highlight's energy
    };
    /// Returns at how many instants a moving highlight is drawn: a power of two up to `most_moments`, or 1
    /// without motion. Between two instants, it may move and grow by half a pixel or, if larger, a quarter
    /// of its CoC radius.
    [[nodiscard]] int moments_wanted(const Highlight& light, const SheetKey& key) const;
    static constexpr int most_moments = 256;
    /// Returns the highlight at `count` instants, spread evenly over the exposure and, if `turned`, shifted
    /// differently for neighbours. Omits instants at which its light misses the image. Without motion,
    /// returns one element with u = -1.
    [[nodiscard]] std::vector<Moment> moments(const Highlight& light, const SheetKey& key, int count,
                                              bool turned = false) const;

  private:
    using Maps = std::vector<RasterMap>;
    /// Returns the motion of an object from the recorded instant to the middle of each of `count` equal parts
    /// of the exposure. Several threads may call this function.
    [[nodiscard]] std::shared_ptr<const Maps> maps(std::uint32_t id, int count) const;
    [[nodiscard]] bool moved(const Highlight& light, const RasterMap& map, Highlight& out) const;

    std::function<bool(std::uint32_t id)> moves_;
    Map map_;
    PatchLens lens_;
    mutable std::mutex mutex_;
    mutable std::map<std::pair<std::uint32_t, int>, std::shared_ptr<const Maps>> known_;
};

}  // namespace postlens
