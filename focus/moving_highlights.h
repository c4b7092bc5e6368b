// Highlights that move while the light comes in: at as many instants as make a streak of their responses.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "reproject/patches.h"
#include "reproject/raster_map.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

class HighlightMotion {
  public:
    /// px^2, of all such light of a sheet: views show more as a streak themselves.
    static constexpr float largest_px2 = 64;
    /// Radiance above the limit: of less no view shows a dot that matters.
    static constexpr float least_radiance = 3;

    /// From the recorded instant to the one until which the share `u` (0 to 1) of the light has come in.
    using Map = std::function<RasterMap(std::uint32_t id, double u)>;
    /// `lens`: what the responses are of.
    HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, PatchLens lens);

    /// Whether what is in such a sheet is seen directly and moves.
    [[nodiscard]] bool moves(const SheetKey& key) const { return key.path.bits() == 0 && moves_(key.id); }
    /// Whether a light that moves is one to be spread along its way.
    [[nodiscard]] static bool takes(const Highlight& light, float area_px2);
    /// Where it is at one instant, with its share of the light.
    struct Moment {
        Highlight light;
        double u = 0;
        double share = 1;  ///< of all instants
    };
    /// How many instants make a streak of a light, a power of two: from one to the next by no more than half
    /// a pixel or a quarter of the blur, of its place and of its rim, if that takes no more than
    /// `most_moments`; 1 where it does not move.
    [[nodiscard]] int moments_wanted(const Highlight& light, const SheetKey& key) const;
    static constexpr int most_moments = 256;
    /// So many, at even shares of the light. What lies behind the camera, or so far from any picture that
    /// nothing of it arrives, is left out. One with u = -1 where it does not move. `turned`: not in the
    /// middles of the shares but anywhere in them, elsewhere for lights at other places: of several that lie
    /// close together a streak is made even though there are fewer than wanted.
    [[nodiscard]] std::vector<Moment> moments(const Highlight& light, const SheetKey& key, int count,
                                              bool turned = false) const;

  private:
    using Maps = std::vector<RasterMap>;
    /// To the middles of `count` even shares. Thread-safe.
    [[nodiscard]] std::shared_ptr<const Maps> maps(std::uint32_t id, int count) const;
    [[nodiscard]] bool moved(const Highlight& light, const RasterMap& map, Highlight& out) const;

    std::function<bool(std::uint32_t id)> moves_;
    Map map_;
    PatchLens lens_;
    mutable std::mutex mutex_;
    mutable std::map<std::pair<std::uint32_t, int>, std::shared_ptr<const Maps>> known_;
};

}  // namespace postlens
