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
    /// Moving highlights are drawn as streaks along their path only if they are small. Their total area on
    /// one surface, within a square of 16 x 16 px, must be less than this, in px^2. A light field, the mean
    /// of images at many instants, already shows larger highlights as streaks.
    static constexpr float largest_px2 = 64;
    /// Moving highlights are drawn as streaks along their path only if their radiance exceeds white by at
    /// least this. A light field, the mean of images at many instants, already shows dimmer highlights as
    /// smooth streaks.
    static constexpr float least_radiance = 3;

    /// Returns the motion of the object `id` on the raster: from the recorded instant (of the sample file) to
    /// the instant at which the fraction `u` (0 to 1) of the exposure has passed.
    using Map = std::function<RasterMap(std::uint32_t id, double u)>;
    /// - `moves`: returns whether an object moves in the image during the exposure
    /// - `map`: returns the motion of an object on the raster
    /// - `lens`: the lens, from which the size of the blur is computed
    HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, PatchLens lens);

    /// Returns whether a surface moves and is seen directly. `key` identifies its object and the reflections
    /// through which it is seen.
    [[nodiscard]] bool moves(const SheetKey& key) const { return key.path.bits() == 0 && moves_(key.id); }
    /// Returns whether a moving highlight is small and bright enough to be drawn as a streak along its path.
    /// `area_px2` is the total area of all highlights on the same surface within a square of 16 x 16 px.
    [[nodiscard]] static bool takes(const Highlight& light, float area_px2);
    /// A moving highlight at one instant of the exposure.
    struct Moment {
        Highlight light;   ///< as seen at the instant
        double u = 0;      ///< fraction of the exposure that has passed, 0 to 1; -1 if always present
        double share = 1;  ///< share of the highlight's energy
    };
    /// Returns at how many instants a moving highlight is drawn: a power of two up to `most_moments`, or 1
    /// without motion. From one instant to the next, its position and blur radius may change by up to half a
    /// pixel. Highlights with a large blur may change by up to a quarter of their blur radius.
    [[nodiscard]] int moments_wanted(const Highlight& light, const SheetKey& key) const;
    static constexpr int most_moments = 256;
    /// Returns the highlight at `count` equally spaced instants of the exposure. A highlight at rest is
    /// returned once, and marked as always present (Moment::u = -1).
    /// - `turned`: whether to shift the instants by an amount that depends on the highlight's position, so
    ///   that neighbouring highlights use different instants
    [[nodiscard]] std::vector<Moment> moments(const Highlight& light, const SheetKey& key, int count,
                                              bool turned = false) const;

  private:
    using Maps = std::vector<RasterMap>;
    /// Divides the exposure into `count` equal intervals. Returns an object's motion on the raster from the
    /// recorded instant to the middle of each interval. Thread-safe.
    [[nodiscard]] std::shared_ptr<const Maps> maps(std::uint32_t id, int count) const;
    [[nodiscard]] bool moved(const Highlight& light, const RasterMap& map, Highlight& out) const;

    std::function<bool(std::uint32_t id)> moves_;
    Map map_;
    PatchLens lens_;
    mutable std::mutex mutex_;
    mutable std::map<std::pair<std::uint32_t, int>, std::shared_ptr<const Maps>> known_;
};

}  // namespace postlens
