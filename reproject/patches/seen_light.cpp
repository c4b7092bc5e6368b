#include "reproject/patches/seen_light.h"

#include <cstring>

#include "core/multiversion.h"

namespace postlens {
namespace {

// SIMD types for a pixel's four sums: r, g, b and weight. Compilers do not vectorise the additions on their
// own.
using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));
static_assert(sizeof(Texel) == sizeof(Float4) && sizeof(LightSums::value_type) == sizeof(Double4));

}  // namespace

POSTLENS_MULTIVERSION void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width,
                                          int height, double weight, LightSums& sums,
                                          PixelList& with_children) {
    const Double4 weights{weight, weight, weight, weight};
    std::size_t count = 0;
    for (int y = 0; y < height; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * SeenTile::edge;
        for (std::size_t k = row; k < row + static_cast<std::size_t>(width); ++k) {
            const std::uint32_t number = seen.texel[k];
            if (number == SeenTile::no_texel) continue;
            const Texel& t = texels[number];
            Float4 light;
            std::memcpy(&light, &t, sizeof light);
            light[3] = 1;
            Double4 sum;
            std::memcpy(&sum, sums[k].data(), sizeof sum);
            sum += weights * __builtin_convertvector(light, Double4);
            std::memcpy(sums[k].data(), &sum, sizeof sum);
            // Every pixel is written to the end of the list, but only pixels with reflections or refractions
            // are counted. The next pixel overwrites one that was not counted. A branch would often be
            // mispredicted.
            with_children.pixels[count] = static_cast<std::uint16_t>(k);
            count += t.children() != 0 ? 1 : 0;
        }
    }
    with_children.count = count;
}

}  // namespace postlens
