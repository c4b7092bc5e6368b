#include "reproject/patches/extra_rays.h"

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>

#include "core/progress.h"
#include "core/sample_hash.h"

namespace postlens {

void ExtraRays::trace(const PatchField& field, const PatchViews& set, const TilePlace& at, LeftToRays left,
                      LightSums& sums) {
    for (int y = 0; y < at.height; ++y) {
        for (int x = 0; x < at.width; ++x) {
            const auto wanted =
                static_cast<std::size_t>(set.extra_rays(at.x - field.x + x, at.y - field.y + y));
            const std::uint64_t pixel = mix64((std::uint64_t{static_cast<std::uint32_t>(at.x + x)} << 32U) |
                                              static_cast<std::uint32_t>(at.y + y));
            for (std::size_t n = 0; n < std::min(wanted, set.extra_lines.size()); ++n) {
                const std::uint64_t seed = mix64(pixel + set.extra_lines[n].front().set);
                const glm::dvec2 turn(unit_float(random_word(seed, 0)), unit_float(random_word(seed, 1)));
                for (std::size_t i = 0; i < set.views.size(); ++i) {
                    SightLine& line = rays_.lines().emplace_back(set.extra_lines[n][i]);
                    line.x = at.x + x;
                    line.y = at.y + y;
                    line.place = glm::fract(line.place + turn);
                    rays_.finish(static_cast<std::size_t>(y * SeenTile::edge + x), set.views[i].weight);
                }
                if (!rays_.full()) continue;
                throw_if_interrupted();
                rays_.trace(set, left, sums);
            }
        }
    }
    rays_.trace(set, left, sums);
}

}  // namespace postlens
