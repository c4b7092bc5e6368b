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
    /// Largest area, in px^2, of a moving highlight that is drawn as a streak along its path. The area is
    /// that of the surface's bright light within a square of 16 x 16 px. Larger highlights are shown by the
    /// mean of images at many instants, where their copies overlap.
    static constexpr float largest_px2 = 64;
    /// Limit for drawing moving highlights as streaks along their path. A highlight's radiance must exceed
    /// white, which is 1, by at least this value in some colour channel. For dimmer highlights, the mean of
    /// images at many instants is smooth enough.
    static constexpr float least_radiance = 3;

    /// Returns how the points of the object `id` move in the image, from the instant that the sample file
    /// records to another instant of the exposure. Until this other instant, the fraction `u` (0 to 1) of the
    /// exposure has passed.
    using Map = std::function<RasterMap(std::uint32_t id, double u)>;
    /// - `moves`: returns whether an object moves in the image during the exposure
    /// - `map`: returns the motion of an object on the raster
    /// - `lens`: the lens, from which the size of the blur is computed
    HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, PatchLens lens);

    /// Returns whether a surface moves and is seen directly, that is, not in a mirror or through glass. `key`
    /// identifies the surface's object and the reflections and transmissions through which it is seen.
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
    /// Returns at how many instants a moving highlight must be drawn so that it looks like a continuous
    /// streak. Between two instants, its position and blur radius may change by half a pixel, or by a quarter
    /// of the blur radius if that is more. The result is a power of two up to `most_moments`, or 1 if the
    /// highlight does not move.
    [[nodiscard]] int moments_wanted(const Highlight& light, const SheetKey& key) const;
    static constexpr int most_moments = 256;
    /// Returns the highlight at `count` equally spaced instants of the exposure. If the highlight does not
    /// move, it is returned only once, and marked as always present (Moment::u is -1).
    /// - `turned`: whether to shift the instants by an amount that depends on the highlight's position, so
    ///   that neighbouring highlights use different instants
    [[nodiscard]] std::vector<Moment> moments(const Highlight& light, const SheetKey& key, int count,
                                              bool turned = false) const;

  private:
    using Maps = std::vector<RasterMap>;
    /// Divides the exposure into `count` equal intervals. For each interval, returns how the points of the
    /// object `id` move in the image, from the instant that the sample file records to the middle of the
    /// interval. Thread-safe.
    [[nodiscard]] std::shared_ptr<const Maps> maps(std::uint32_t id, int count) const;
    [[nodiscard]] bool moved(const Highlight& light, const RasterMap& map, Highlight& out) const;

    std::function<bool(std::uint32_t id)> moves_;
    Map map_;
    PatchLens lens_;
    mutable std::mutex mutex_;
    mutable std::map<std::pair<std::uint32_t, int>, std::shared_ptr<const Maps>> known_;
};

}  // namespace postlens
