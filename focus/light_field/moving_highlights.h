// Highlights that move during the exposure. Each is spread by its impulse responses at many instants, which
// form a continuous streak.
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
    /// Largest total area, in px^2, of moving highlights of a sheet (surface in a square of the raster) that
    /// are spread as streaks. Views show larger ones as streaks.
    static constexpr float largest_px2 = 64;
    /// A highlight is spread as a streak only if its radiance exceeds the limit for highlights by this.
    /// Dimmer ones already look smooth in the mean of the views.
    static constexpr float least_radiance = 3;

    /// Returns the motion of an object from the recorded instant to another one, at which the fraction `u` (0
    /// to 1) of the exposure has passed.
    using Map = std::function<RasterMap(std::uint32_t id, double u)>;
    /// - `moves`: whether an object moves on the raster
    /// - `map`: the motion of an object
    /// - `lens`: determines the size of the impulse responses
    HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, PatchLens lens);

    /// Returns whether the surface with this key (its path and object) is seen directly and moves.
    [[nodiscard]] bool moves(const SheetKey& key) const { return key.path.bits() == 0 && moves_(key.id); }
    /// Returns whether a moving highlight is spread as a streak. `area_px2` is BrightSheet::area_px2.
    [[nodiscard]] static bool takes(const Highlight& light, float area_px2);
    /// A highlight at one instant.
    struct Moment {
        Highlight light;   ///< as seen at the instant
        double u = 0;      ///< fraction of the exposure that has passed, 0 to 1; -1 if always present
        double share = 1;  ///< share of the highlight's energy
    };
    /// Returns how many instants a highlight needs for a continuous streak: a power of two up to
    /// `most_moments`, or 1 without motion.
    ///
    /// Between two instants, it may move and grow by half a pixel. If its CoC radius is above 2 px, a quarter
    /// of the radius is allowed.
    [[nodiscard]] int moments_wanted(const Highlight& light, const SheetKey& key) const;
    static constexpr int most_moments = 256;
    /// Returns the highlight at `count` instants, the middles of equal parts of the exposure. Instants at
    /// which its light cannot reach an image are omitted. Without motion, there is one element, with u = -1.
    ///
    /// `turned` shifts the instants differently for neighbouring highlights, so that their common streak
    /// needs fewer.
    [[nodiscard]] std::vector<Moment> moments(const Highlight& light, const SheetKey& key, int count,
                                              bool turned = false) const;

  private:
    using Maps = std::vector<RasterMap>;
    /// Divides the exposure into `count` equal parts. Returns the motion of an object from the recorded
    /// instant to the middle of each part. Several threads may call this function.
    [[nodiscard]] std::shared_ptr<const Maps> maps(std::uint32_t id, int count) const;
    [[nodiscard]] bool moved(const Highlight& light, const RasterMap& map, Highlight& out) const;

    std::function<bool(std::uint32_t id)> moves_;
    Map map_;
    PatchLens lens_;
    mutable std::mutex mutex_;
    mutable std::map<std::pair<std::uint32_t, int>, std::shared_ptr<const Maps>> known_;
};

}  // namespace postlens
