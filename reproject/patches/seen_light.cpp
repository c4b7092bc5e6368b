#include "reproject/patches/seen_light.h"

#include <algorithm>
#include <cstring>

#include "core/multiversion.h"

#ifdef POSTLENS_FOR_INSTRUCTION_SET
#include <bit>
#include <immintrin.h>
#endif

namespace postlens {
namespace {

// SIMD types for a pixel's four sums: r, g, b and weight. Compilers do not vectorise the additions on their
// own.
using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));
static_assert(sizeof(Texel) == sizeof(Float4) && sizeof(LightSums::value_type) == sizeof(Double4));

/// As find_doubtful_pixels.
void find_one_by_one(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                     std::uint32_t doubts, PixelList& found) {
    std::size_t count = 0;
    for (int y = 0; y < height; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * SeenTile::edge;
        for (std::size_t k = row; k < row + static_cast<std::size_t>(width); ++k) {
            const std::uint32_t number = seen.texel[k];
            // This loop lists the pixels whose colour is uncertain. Every pixel is written to the end of the
            // list, but only an uncertain one advances `count`. Otherwise, the next pixel overwrites it. This
            // avoids a branch, which the processor would often mispredict.
            found.pixels[count] = static_cast<std::uint16_t>(k);
            count +=
                number == SeenTile::no_texel || seen.may_be_hidden(k) || (texels[number].info & doubts) != 0
                    ? 1
                    : 0;
        }
    }
    found.count = count;
}

#ifdef POSTLENS_FOR_INSTRUCTION_SET
POSTLENS_FOR_INSTRUCTION_SET("default")
void find_doubtful(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                   std::uint32_t doubts, PixelList& found) {
    find_one_by_one(texels, seen, width, height, doubts, found);
}
POSTLENS_FOR_INSTRUCTION_SET("arch=x86-64-v3")
void find_doubtful(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                   std::uint32_t doubts, PixelList& found) {
    find_one_by_one(texels, seen, width, height, doubts, found);
}
POSTLENS_FOR_INSTRUCTION_SET("arch=x86-64-v4")
void find_doubtful(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                   std::uint32_t doubts, PixelList& found) {
    // The gather instruction reads values at signed 32-bit offsets. Its largest unit is 8 bytes, so the
    // offset of a 16-byte Texel is twice its index. With more than 2^30 texels, the offset would overflow, so
    // the pixels are tested one by one.
    if (texels.empty() || texels.size() > std::size_t{1} << 30U) {
        find_one_by_one(texels, seen, width, height, doubts, found);
        return;
    }
    constexpr int lanes = 16;
    static_assert(SeenTile::edge % lanes == 0, "the last lanes would read beyond a row");
    const __m512i of_lane = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0),
                  doubt = _mm512_set1_epi32(std::bit_cast<int>(doubts));
    found.count = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; x += lanes) {
            const int k = y * SeenTile::edge + x;
            const unsigned inside = (1U << std::min(width - x, lanes)) - 1;
            const __m512i texel = _mm512_loadu_si512(seen.texel.data() + k);
            const __mmask16 some =
                _mm512_mask_cmpneq_epi32_mask(static_cast<__mmask16>(inside), texel,
                                              _mm512_set1_epi32(std::bit_cast<int>(SeenTile::no_texel)));
            const __m512i info =
                _mm512_mask_i32gather_epi32(texel, some, _mm512_add_epi32(texel, texel), &texels[0].info, 8);
            const __mmask16 hidden =
                _mm512_cmp_ps_mask(_mm512_loadu_ps(seen.maybe_inverse_z.data() + k),
                                   _mm512_loadu_ps(seen.inverse_z.data() + k), _CMP_GT_OQ);
            const unsigned listed = (~unsigned{some} | hidden | _mm512_test_epi32_mask(info, doubt)) & inside;
            const __m512i pixel = _mm512_maskz_compress_epi32(
                static_cast<__mmask16>(listed), _mm512_add_epi32(of_lane, _mm512_set1_epi32(k)));
            const auto count = static_cast<unsigned>(std::popcount(listed));
            _mm512_mask_cvtepi32_storeu_epi16(found.pixels.data() + found.count,
                                              static_cast<__mmask16>((1U << count) - 1), pixel);
            found.count += count;
        }
    }
}
#endif

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
            // Every pixel is written to the end of the list `with_children`, but only a pixel with
            // reflections or refractions increases the length of the list. Therefore, the next pixel
            // overwrites one that does not belong to the list. A branch instead would often be mispredicted.
            with_children.pixels[count] = static_cast<std::uint16_t>(k);
            count += t.children() != 0 ? 1 : 0;
        }
    }
    with_children.count = count;
}

void find_doubtful_pixels(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                          std::uint32_t doubts, PixelList& found) {
#ifdef POSTLENS_FOR_INSTRUCTION_SET
    find_doubtful(texels, seen, width, height, doubts, found);
#else
    find_one_by_one(texels, seen, width, height, doubts, found);
#endif
}

}  // namespace postlens
