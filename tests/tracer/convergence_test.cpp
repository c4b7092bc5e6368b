// Rates at which `render` converges with the number of samples, for each sampler.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "tests/support/scene_builder.h"
#include "tracer/render.h"

namespace postlens::test::convergence_test {
namespace {

// A moving, defocused wall with smooth waves. The integrand has no edges, so a sampler reaches its best rate.
Scene smooth_scene() {
    ImageTexture waves;
    waves.width = waves.height = 128;
    waves.rgb.resize(3 * 128 * 128);
    for (std::size_t i = 0; i < waves.rgb.size(); ++i) {
        const std::size_t texel = i / 3, row = texel / 128, column = texel % 128;
        const auto x = static_cast<double>(column), y = static_cast<double>(row);
        const double turn = 2 * std::numbers::pi / 128;
        waves.rgb[i] = static_cast<float>(1 + 0.5 * std::cos(turn * (3 * x + static_cast<double>(i % 3))) *
                                                  std::cos(turn * 2 * y));
    }
    SceneBuilder b;
    Material m = glowing(glm::dvec3(1));
    m.emission_texture = std::make_shared<const Texture>(std::move(waves));
    Object& wall = b.add(test::square({0, 0, -4}, {0, 0, 1}, 4), m);
    wall.keys = {{0}, {1, {0.3, 0.1, 0}}};
    b.scene.cameras[0].width = 12;
    b.scene.cameras[0].height = 8;
    return b.scene;
}

// The noise: RMS difference, over seeds and pixels, of images from the mean over all seeds.
double noise(const Scene& scene, SamplerKind sampler, int spp, int seeds) {
    RenderSettings s;
    s.f_number = 0.5;
    s.focus_m = 2;
    s.shutter = TimeSpan{0, 1};
    s.sampler = sampler;
    s.spp = spp;
    std::vector<Image> pictures;
    for (int seed = 0; seed < seeds; ++seed) {
        s.seed = static_cast<std::uint64_t>(seed);
        pictures.push_back(render_picture(scene, s).image);
    }
    double sum = 0;
    const std::size_t values = pictures[0].rgb.size();
    for (std::size_t i = 0; i < values; ++i) {
        double mean = 0, square = 0;
        for (const Image& p : pictures) mean += static_cast<double>(p.rgb[i]) / seeds;
        for (const Image& p : pictures) {
            const double d = static_cast<double>(p.rgb[i]) - mean;
            square += d * d;
        }
        sum += square / (seeds - 1);
    }
    return std::sqrt(sum / static_cast<double>(values));
}

// The exponent of n in the noise, by a least-squares fit of logarithms.
double slope(const Scene& scene, SamplerKind sampler) {
    constexpr int seeds = 16;
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    int count = 0;
    for (const int spp : {4, 16, 64, 256}) {
        const double x = std::log(spp), y = std::log(noise(scene, sampler, spp, seeds));
        sx += x, sy += y, sxx += x * x, sxy += x * y;
        ++count;
    }
    return (count * sxy - sx * sy) / (count * sxx - sx * sx);
}

// The noise is measured with 15 degrees of freedom at each of 96 pixels (the channels are nearly equal). Its
// standard error is 1 / sqrt(2 * 15 * 96) = 1.9 %. For values of n that are log 4 = 1.386 apart, the standard
// error of the slope is 0.019 / (1.386 * sqrt(5)) = 0.006. The band is four of these, 0.025.
constexpr double band = 0.025;

TEST(Convergence, RandomFallsAsTheRoot) {
    EXPECT_NEAR(slope(smooth_scene(), SamplerKind::random), -0.5, band);
}

TEST(Convergence, SobolFallsFasterOnSmoothScenes) {
    EXPECT_LT(slope(smooth_scene(), SamplerKind::sobol), -0.7 - band);
}

// Pixel, lens and time are stratified separately and paired at random. The noise of terms that couple them
// falls as n^-1/2; that of the other terms falls faster.
TEST(Convergence, StrataAreBetweenTheTwo) {
    const Scene scene = smooth_scene();
    for (const SamplerKind kind : {SamplerKind::jittered, SamplerKind::poisson}) {
        const double s = slope(scene, kind);
        EXPECT_LT(s, -0.5 + band) << static_cast<int>(kind);
        EXPECT_GT(s, slope(scene, SamplerKind::sobol) - band) << static_cast<int>(kind);
        EXPECT_LT(noise(scene, kind, 64, 16), noise(scene, SamplerKind::random, 64, 16))
            << static_cast<int>(kind);
    }
}

}  // namespace
}  // namespace postlens::test::convergence_test
