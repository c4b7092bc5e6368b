#include "reproject/patches/extra_rays.h"

#include <cstddef>
#include <glm/glm.hpp>

#include "core/sample_hash.h"

namespace postlens {

void ExtraRays::trace(const PatchField& field, const PatchViews& set, const TilePlace& at, LeftToRays left,
                      LightSums& sums) {
    lines_.clear();
    pixel_.clear();
    weight_.clear();
    const std::size_t count = set.views.size();
    for (int y = 0; y < at.height; ++y) {
        for (int x = 0; x < at.width; ++x) {
            const int rays = set.extra_rays(at.x - field.x + x, at.y - field.y + y);
            for (int n = 1; n <= rays; ++n) {
                const std::uint32_t first = set.views.front().set;
                const std::uint64_t seed =
                    mix64(mix64((std::uint64_t{static_cast<std::uint32_t>(at.x + x)} << 32U) |
                                static_cast<std::uint32_t>(at.y + y)) +
                          (std::uint64_t{first} << 32U) + static_cast<std::uint64_t>(n));
                const glm::dvec2 turn(unit_float(random_word(seed, 0)), unit_float(random_word(seed, 1)));
                const std::size_t step = random_word(seed, 2) % count;
                for (std::size_t i = 0; i < count; ++i) {
                    // A position in the pixel is combined with the lens point and instant of another view.
                    const PatchView &place = set.views[i], &lens = set.views[(i + step) % count];
                    SightLine& line = lines_.emplace_back();
                    line.x = at.x + x;
                    line.y = at.y + y;
                    line.place = glm::fract(place.sample + turn);
                    line.lens = lens.lens_point;
                    line.light_before = lens.light_before;
                    line.set = place.set + (static_cast<std::uint32_t>(n) << 16U);
                    line.view = place.number;
                    pixel_.push_back(static_cast<std::uint16_t>(y * SeenTile::edge + x));
                    weight_.push_back(place.weight);
                }
            }
        }
    }
    if (lines_.empty()) return;
    radiance_.resize(lines_.size());
    set.rays->trace(lines_, left == LeftToRays::samples_and_lights ? LightElsewhere{} : set.less, radiance_);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        auto& of = sums[pixel_[i]];
        for (std::size_t c = 0; c < 3; ++c) of[c] += weight_[i] * static_cast<double>(radiance_[i][c]);
        of[3] += weight_[i];
    }
}

}  // namespace postlens
