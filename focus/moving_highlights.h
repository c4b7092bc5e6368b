// Highlights that move while the light comes in: at as many instants as make a streak of their responses.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches.h"
#include "reproject/raster_map.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

class HighlightMotion {
  public:
    /// px^2, of a moving light: views show larger ones as a streak themselves.
    static constexpr float largest_px2 = 64;

    /// From the recorded instant to the one until which the share `u` (0 to 1) of the light has come in.
    using Map = std::function<RasterMap(std::uint32_t id, double u)>;
    /// `lens`: what the responses are of.
    HighlightMotion(std::function<bool(std::uint32_t id)> moves, Map map, const PatchLens& lens);

    /// Whether a light that is seen directly, in what has this id, is one to be spread along its way.
    [[nodiscard]] bool takes(std::uint32_t id, float area_px2) const {
        return area_px2 < largest_px2 && moves_(id);
    }
    /// Where it is at one instant, with its share of the light.
    struct Moment {
        Highlight light;
        double u = 0;
        double share = 1;  ///< of all instants
    };
    /// At even shares of the light, from one to the next by no more than half a pixel or a quarter of the
    /// blur, of its place and of its rim; at most `most_moments`. What lies behind the camera is left out.
    /// One with u = -1 where it does not move.
    [[nodiscard]] std::vector<Moment> moments(const Highlight& light, const SheetKey& key) const;
    static constexpr int most_moments = 2048;

  private:
    [[nodiscard]] bool at(const Highlight& light, std::uint32_t id, double u, Highlight& out) const;

    std::function<bool(std::uint32_t id)> moves_;
    Map map_;
    PatchLens lens_;
};

}  // namespace postlens
