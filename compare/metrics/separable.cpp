#include "compare/metrics/separable.h"

#include <array>

#include "core/multiversion.h"

namespace postlens {
namespace {

// Output values computed together. Their sums stay in registers.
constexpr std::size_t block_px = 32;
static_assert(tile_width % block_px == 0);

}  // namespace

POSTLENS_MULTIVERSION
void filter_rows(const TileChannel& in, int rows, std::span<const float> taps, TileChannel& out) {
    const std::size_t in_stride = tile_width + taps.size() - 1;
    const float* const weights = taps.data();
    const std::size_t tap_count = taps.size();
    for (std::size_t y = 0; y < static_cast<std::size_t>(rows); ++y) {
        for (std::size_t x = 0; x < tile_width; x += block_px) {
            const float* const from = in.data() + y * in_stride + x;
            std::array<float, block_px> sum{};
            for (std::size_t k = 0; k < tap_count; ++k) {
                for (std::size_t i = 0; i < block_px; ++i) sum[i] += weights[k] * from[i + k];
            }
            std::copy(sum.begin(), sum.end(), out.data() + y * tile_width + x);
        }
    }
}

POSTLENS_MULTIVERSION
void filter_columns(const TileChannel& in, std::span<const float> taps, TileChannel& out) {
    const float* const weights = taps.data();
    const std::size_t tap_count = taps.size();
    for (std::size_t y = 0; y < tile_height; ++y) {
        for (std::size_t x = 0; x < tile_width; x += block_px) {
            const float* const from = in.data() + y * tile_width + x;
            std::array<float, block_px> sum{};
            for (std::size_t k = 0; k < tap_count; ++k) {
                for (std::size_t i = 0; i < block_px; ++i) sum[i] += weights[k] * from[i + k * tile_width];
            }
            std::copy(sum.begin(), sum.end(), out.data() + y * tile_width + x);
        }
    }
}

}  // namespace postlens
