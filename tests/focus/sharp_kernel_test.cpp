// The kernels of almost sharp light sources.
#include "focus/light_field/sharp_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "focus/responses/response_model.h"
#include "lens/impulse.h"

namespace postlens::test::sharp_kernel_test {
namespace {

constexpr KernelReach far{100, 100};
constexpr int edge = 8;  // pixels
using Pixels = std::array<double, std::size_t{edge} * edge>;

/// The kernel's values in the pixels from -edge / 2 to edge / 2.
Pixels values_of(const Kernel& kernel) {
    Pixels out{};
    for (int y = kernel.y_begin; y < kernel.y_end(); ++y) {
        const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - kernel.y_begin)];
        for (int x = row.x_begin; x < row.x_end; ++x)
            out.at(static_cast<std::size_t>((y + edge / 2) * edge + x + edge / 2)) = kernel.at(row, x);
    }
    return out;
}

/// Slow and obvious: light from points in the parts, through points of a round aperture.
Pixels reference(const std::vector<SourcePart>& parts, const glm::dvec2& centre, const glm::dmat2& map) {
    constexpr int in_part = 96, in_lens = 96;
    Pixels out{};
    double sum = 0;
    for (const SourcePart& part : parts) {
        for (int i = 0; i < in_part * in_part; ++i) {
            const glm::dvec2 in(((i % in_part) + 0.5) / in_part - 0.5, ((i / in_part) + 0.5) / in_part - 0.5),
                from = centre + glm::dvec2(part.at) + glm::dvec2(part.size) * in;
            const auto weight = static_cast<double>(part.light);
            for (int k = 0; k < in_lens * in_lens; ++k) {
                const glm::dvec2 lens(2 * ((k % in_lens) + 0.5) / in_lens - 1,
                                      2 * ((k / in_lens) + 0.5) / in_lens - 1);
                if (glm::dot(lens, lens) > 1) continue;
                const glm::ivec2 pixel(glm::floor(from + map * lens));
                out.at(static_cast<std::size_t>((pixel.y + edge / 2) * edge + pixel.x + edge / 2)) += weight;
                sum += weight;
            }
        }
    }
    for (double& v : out) v /= sum;
    return out;
}

// A quarter of a pixel that meets the border of a pixel, and a strip in the next pixel.
const std::vector<SourcePart> parts{{{-0.125F, 0.0F}, {0.25F, 0.25F}, 0.0625F, 0.0625F},
                                    {{0.005F, 0.08F}, {0.01F, 0.2F}, 0.0645F, 0.002F}};

TEST(SharpKernel, IsTheMeanOfTheKernelsOfAllPoints) {
    const glm::dvec2 centre(1, 0.8);
    for (const glm::dmat2& map : {glm::dmat2(0.01), glm::dmat2(0.07), glm::dmat2(-0.3), glm::dmat2(1.4),
                                  glm::dmat2(0.1, 0.2, -0.6, 0.8)}) {
        const Kernel kernel = sharp_kernel(parts, centre, map, ResponseModel(), far);
        const Pixels got = values_of(kernel), wanted = reference(parts, centre, map);
        double sum = 0;
        for (std::size_t i = 0; i < got.size(); ++i) {
            // The reference has steps of a hundredth of the part's and the blur's width, and the kernel's
            // points have an error of a hundredth of a quarter of the blur.
            EXPECT_NEAR(got.at(i), wanted.at(i), 0.002) << i << " of " << map[0].x;
            sum += got.at(i);
        }
        EXPECT_NEAR(sum, 1, 1e-6);
    }
}

// Without blur, the kernel is the share of the light's area in each pixel.
TEST(SharpKernel, DividesALightWithoutBlurByItsArea) {
    const Pixels got = values_of(sharp_kernel(parts, {1, 0.8}, glm::dmat2(0), ResponseModel(), far));
    const double strip = 0.01 * 0.2, all = 0.25 * 0.25 + strip;
    const auto at = [&](int x, int y) {
        return got.at(static_cast<std::size_t>((y + edge / 2) * edge + x + edge / 2));
    };
    // Without blur, a point is a disc of 1e-4 px. The border of the pixel divides it if the light touches it.
    EXPECT_NEAR(at(0, 0), 0.25 * 0.25 / all, 1e-4);
    EXPECT_NEAR(at(1, 0), strip / all, 1e-4);
}

// A blur below half a pixel is that of a disc, whatever the shape of the aperture.
TEST(SharpKernel, HoldsAllLightOfAPolygon) {
    FocusGeometry geometry;
    geometry.gain_px = 1000;
    geometry.aperture_radius_m = 0.01;
    const std::unique_ptr<ResponseModel> model =
        response_model(parse_impulse("--impulse", "polygon:5:10"), geometry, 100);
    for (const double radius_px : {0.0, 0.2, 1.7}) {
        double sum = 0;
        for (const double v : values_of(sharp_kernel(parts, {1, 0.8}, glm::dmat2(radius_px), *model, far)))
            sum += v;
        EXPECT_NEAR(sum, 1, 1e-5) << radius_px;
    }
}

}  // namespace
}  // namespace postlens::test::sharp_kernel_test
