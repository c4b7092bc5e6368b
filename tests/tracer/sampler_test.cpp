// Point sets of distributed rays: range and uniformity of points, and independence of sets, pixels and seeds.
// The tolerances are 4.5 standard errors, which chance exceeds with a probability of 7e-6; seeds are fixed.
#include "tracer/sampling/sampler.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numeric>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/threads.h"
#include "tests/tracer/point_statistics.h"

namespace postlens::test::sampler_test {
namespace {

const SampleSet light_set = sample_set(4, 17, 2);

TEST(Sampler, RefusesSamplesPerPixelOutOfRange) {
    for (const int spp : {0, -1, (1 << 20) + 1}) {
        try {
            const Sampler s(SamplerKind::sobol, spp, 1);
            FAIL() << spp;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::wrong_arguments);
            EXPECT_EQ(std::string(e.what()),
                      "--spp: out of range (got " + std::to_string(spp) + "; expected 1 to 1048576)");
        }
    }
    EXPECT_EQ(Sampler(SamplerKind::sobol, 1 << 20, 1).spp(), 1 << 20);
}

TEST(Sampler, SetsMadeByHashingAreNoneOfTheEyeRay) {
    static_assert(sample_set(0, 0, 0).id > time_set.id);
    std::set<std::uint32_t> ids;
    for (std::uint32_t purpose = 0; purpose < 8; ++purpose) {
        for (std::uint32_t a = 0; a < 32; ++a) {
            for (std::uint32_t b = 0; b < 32; ++b) {
                ids.insert(sample_set(purpose, a, b).id);
                EXPECT_GT(sample_set(purpose, a, b).id, time_set.id);
            }
        }
    }
    // For 8192 words of 32 bits, 2^26 / 2 / 2^32 = 0.008 collisions are expected.
    EXPECT_EQ(ids.size(), 8192U);
}

class EverySampler : public testing::TestWithParam<SamplerKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EverySampler, testing::ValuesIn(all_kinds),
                         [](const auto& kind) { return name_of(kind.param); });

TEST_P(EverySampler, LiesInTheUnitInterval) {
    for (const int spp : {1, 2, 3, 7, 16, 17, 64, 1000, 1500, 1 << 20}) {
        const Sampler s(GetParam(), spp, 3);
        for (const SampleSet set : {pixel_set, lens_set, time_set, light_set}) {
            // Tests all samples if there are few, else the first and last 2000.
            for (int i = 0; i < spp; i = i == 1999 ? std::max(2000, spp - 2000) : i + 1) {
                const glm::vec2 p = s.point_2d(9, set, i);
                const float t = s.point_1d(9, set, i);
                ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1 && t >= 0 && t < 1) << spp << ' ' << i;
            }
        }
    }
}

TEST_P(EverySampler, SameBitsHoweverAsked) {
    for (const int spp : {1, 5, 16, 40, 1027, 3000}) {
        const Sampler s(GetParam(), spp, 11);
        for (const std::uint32_t pixel : {0U, 1U, 0xffffffffU}) {
            for (int first = 0; first < spp; first += std::max(1, spp / 37)) {
                for (const int wanted : {1, 3, 15, 16}) {
                    const int count = std::min(wanted, spp - first);
                    Sampler::EyeSamples eye{};
                    s.fill_eye(pixel, first, count, eye);
                    // One more element, to check that nothing is written beyond `count`.
                    float u[sample_lanes + 1], v[sample_lanes + 1], t[sample_lanes + 1];
                    for (const SampleSet set : {pixel_set, lens_set, time_set, light_set}) {
                        std::fill_n(u, sample_lanes + 1, -1.0F);
                        std::fill_n(v, sample_lanes + 1, -1.0F);
                        std::fill_n(t, sample_lanes + 1, -1.0F);
                        s.fill_2d(pixel, set, first, count, u, v);
                        s.fill_1d(pixel, set, first, count, t);
                        for (int i = 0; i < count; ++i) {
                            const glm::vec2 p = s.point_2d(pixel, set, first + i);
                            ASSERT_EQ(p, glm::vec2(u[i], v[i])) << spp << ' ' << first << ' ' << i;
                            ASSERT_EQ(s.point_1d(pixel, set, first + i), t[i]);
                            if (set.id == pixel_set.id) {
                                ASSERT_EQ(p, glm::vec2(eye.pixel_u[i], eye.pixel_v[i]));
                            }
                            if (set.id == lens_set.id) {
                                ASSERT_EQ(p, glm::vec2(eye.lens_u[i], eye.lens_v[i]));
                            }
                            if (set.id == time_set.id) {
                                ASSERT_EQ(t[i], eye.time_u[i]);
                            }
                        }
                        ASSERT_TRUE(u[count] == -1 && v[count] == -1 && t[count] == -1);
                    }
                }
            }
        }
    }
}

TEST_P(EverySampler, SameBitsForAnyNumberOfThreads) {
    const Sampler s(GetParam(), 64, 5);
    std::vector<float> alone(4096), together(4096);
    const auto fill = [&](std::vector<float>& out, std::size_t p) {
        for (int k = 0; k < 4; ++k)
            s.fill_1d(static_cast<std::uint32_t>(p), time_set, 16 * k, 16,
                      &out[p * 64 + 16U * static_cast<unsigned>(k)]);
    };
    for (std::size_t p = 0; p < 64; ++p) fill(alone, p);
    parallel_for(64, [&](std::size_t p) { fill(together, 63 - p); });
    EXPECT_EQ(alone, together);
}

// Over pixels, a sample of given index has mean 1/2 and variance 1/12 within the errors of uniform numbers.
// The fourth moment is 1/80, so the error of the variance is sqrt(1/180 / N). `grid` is uniform over the
// centres of 12 cells, whose variance is less by (1/12) / cells^2.
TEST_P(EverySampler, EverySampleIsUniformOverPixels) {
    constexpr int pixels = 20000, spp = 12;
    const Sampler s(GetParam(), spp, 77);
    for (const int index : {0, 1, 7, 11}) {
        std::vector<std::vector<double>> x(7, std::vector<double>(pixels));
        for (std::size_t p = 0; p < pixels; ++p) {
            const auto pixel = static_cast<std::uint32_t>(p);
            const glm::vec2 a = s.point_2d(pixel, pixel_set, index), b = s.point_2d(pixel, lens_set, index),
                            c = s.point_2d(pixel, light_set, index);
            x[0][p] = s.point_1d(pixel, time_set, index);
            x[1][p] = s.point_1d(pixel, light_set, index);
            x[2][p] = b.x, x[3][p] = b.y, x[4][p] = c.x, x[5][p] = c.y, x[6][p] = a.x;
        }
        const bool cells = GetParam() == SamplerKind::grid,
                   stays = cells || GetParam() == SamplerKind::jittered;
        for (std::size_t k = 0; k < (stays ? 6U : 7U); ++k) {
            EXPECT_NEAR(mean(x[k]), 0.5, 4.5 * std::sqrt(1.0 / 12 / pixels)) << index << ' ' << k;
            const double coarse = !cells ? 0 : k < 2 ? 1.0 / 144 : 1.0 / 9;
            // The 12 cells form three rows of four.
            const double low = k == 3 || k == 5 ? 1.0 / 9 : k < 2 ? 1.0 / 144 : 1.0 / 16;
            EXPECT_NEAR(variance(x[k]), (1 - (coarse > 0 ? low : 0)) / 12,
                        4.5 * std::sqrt(1.0 / 180 / pixels))
                << index << ' ' << k;
        }
    }
}

// Samples of one index are uncorrelated with those of neighbouring pixels, other seeds and other sets. The
// correlation coefficient of independent numbers has a standard error of 1 / sqrt(N) over N pixels.
TEST_P(EverySampler, SetsPixelsAndSeedsAreUncorrelated) {
    constexpr int width = 128, pixels = width * width, spp = 16;
    const double limit = 4.5 / std::sqrt(static_cast<double>(pixels));
    const Sampler s(GetParam(), spp, 1), other(GetParam(), spp, 2);
    // Cells of the pixel set are not permuted, so only the position in a cell is random; `grid` has no such
    // position.
    const bool has_pixel = GetParam() != SamplerKind::grid;
    for (const int index : {0, 5, 15}) {
        using Row = std::vector<double>;
        std::vector<Row> x;
        const auto add = [&](auto value) {
            Row row(pixels);
            for (std::uint32_t p = 0; p < pixels; ++p) row[p] = value(p);
            x.push_back(std::move(row));
        };
        for (const Sampler* from : {&s, &other}) {
            for (const SampleSet set : {lens_set, light_set, pixel_set}) {
                if (set.id == pixel_set.id && !has_pixel) continue;
                add([&](std::uint32_t p) { return from->point_2d(p, set, index).x; });
                add([&](std::uint32_t p) { return from->point_2d(p, set, index).y; });
            }
            add([&](std::uint32_t p) { return from->point_1d(p, time_set, index); });
            add([&](std::uint32_t p) { return from->point_1d(p, light_set, index); });
        }
        // Pixels to the right, below, and at distances of 2^16 and 2^31.
        for (const std::uint32_t step : {1U, static_cast<std::uint32_t>(width), 1U << 16, 1U << 31}) {
            add([&](std::uint32_t p) { return s.point_2d(p + step, lens_set, index).x; });
            add([&](std::uint32_t p) { return s.point_1d(p + step, time_set, index); });
            if (has_pixel) add([&](std::uint32_t p) { return s.point_2d(p + step, pixel_set, index).x; });
        }
        for (std::size_t a = 0; a < x.size(); ++a) {
            for (std::size_t b = 0; b < a; ++b) {
                // Two columns may hold the same pixels with an offset, but still different numbers.
                EXPECT_LT(std::abs(correlation(x[a], x[b])), limit) << index << ' ' << a << ' ' << b;
            }
        }
    }
}

// Sets are also uncorrelated over all samples of many pixels. Samples of a pixel are stratified, so the
// standard error is at most that of N independent pairs, 1 / sqrt(N).
TEST_P(EverySampler, SetsOfAPixelArePairedEvenly) {
    constexpr int pixels = 4000, spp = 16;
    const Sampler s(GetParam(), spp, 9);
    std::vector<std::vector<double>> x(6);
    for (std::uint32_t p = 0; p < pixels; ++p) {
        Sampler::EyeSamples e{};
        s.fill_eye(p, 0, 16, e);
        for (std::size_t i = 0; i < spp; ++i) {
            x[0].push_back(e.pixel_u[i]), x[1].push_back(e.pixel_v[i]), x[2].push_back(e.lens_u[i]);
            x[3].push_back(e.lens_v[i]), x[4].push_back(e.time_u[i]);
            x[5].push_back(s.point_1d(p, light_set, static_cast<int>(i)));
        }
    }
    for (std::size_t a = 0; a < x.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b)
            EXPECT_LT(std::abs(correlation(x[a], x[b])), 4.5 / std::sqrt(static_cast<double>(pixels * spp)))
                << a << ' ' << b;
    }
}

TEST_P(EverySampler, AnotherSeedSetOrPixelChangesEverything) {
    constexpr int spp = 64;
    const Sampler s(GetParam(), spp, 1), other(GetParam(), spp, 2);
    const bool grid = GetParam() == SamplerKind::grid;
    const auto equal = [&](const Sampler& a, std::uint32_t p, SampleSet p_set, const Sampler& b,
                           std::uint32_t q, SampleSet q_set) {
        int same = 0;
        for (int i = 0; i < spp; ++i) {
            same += a.point_2d(p, p_set, i) == b.point_2d(q, q_set, i) ? 1 : 0;
            same += a.point_1d(p, p_set, i) == b.point_1d(q, q_set, i) ? 1 : 0;
        }
        return same;
    };
    // Two random permutations of 64 centres agree in one element on average, and in k elements with
    // probability 1 / (e k!), so that 9 agreements occur once in 10^5. The other samplers have numbers of 24
    // bits.
    const int limit = grid ? 12 : 0;
    EXPECT_LE(equal(s, 3, lens_set, other, 3, lens_set), limit);
    EXPECT_LE(equal(s, 3, lens_set, s, 4, lens_set), limit);
    EXPECT_LE(equal(s, 3, lens_set, s, 3, light_set), limit);
    EXPECT_LE(equal(s, 3, time_set, s, 3, light_set), limit);
    EXPECT_LE(equal(s, 3, sample_set(1, 2, 3), s, 3, sample_set(1, 3, 2)), limit);
    if (!grid) {
        EXPECT_LE(equal(s, 3, pixel_set, other, 3, pixel_set), limit);
    }
}

// `random` must be uniform over 16 x 16 cells and over the low eight of its 24 bits. A chi-square with 255
// degrees of freedom has mean 255 and standard deviation 22.6.
TEST(RandomSampler, UniformByChiSquare) {
    const Sampler s(SamplerKind::random, 4096, 5);
    std::vector<int> plane(256), low(256), pairs(256);
    float last = 0;
    for (std::uint32_t p = 0; p < 64; ++p) {
        for (int i = 0; i < 4096; ++i) {
            const glm::vec2 x = s.point_2d(p, lens_set, i);
            const float t = s.point_1d(p, time_set, i);
            ++plane[cell_of(x.x, 16) + 16 * cell_of(x.y, 16)];
            ++low[static_cast<unsigned>(x.x * 0x1p24F) & 255U];
            ++pairs[cell_of(t, 16) + 16 * cell_of(last, 16)];
            last = t;
        }
    }
    for (const auto* counts : {&plane, &low, &pairs}) {
        EXPECT_LT(chi_square(*counts), 255 + 4.5 * 22.6);
        EXPECT_GT(chi_square(*counts), 255 - 4.5 * 22.6);  // a too uniform distribution is not random
    }
}

// RMS error of the mean of a smooth function of all five dimensions, over 32 scrambles (seeds) and 64 pixels.
double rmse(SamplerKind kind, int spp) {
    double sum = 0;
    constexpr int pixels = 64, seeds = 32;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const Sampler s(kind, spp, seed);
        for (std::uint32_t p = 0; p < pixels; ++p) {
            double total = 0;
            for (int first = 0; first < spp; first += 16) {
                Sampler::EyeSamples e{};
                s.fill_eye(p, first, 16, e);
                for (int i = 0; i < 16; ++i)
                    total += smooth(e.pixel_u[i]) * smooth(e.pixel_v[i]) * smooth(e.lens_u[i]) *
                             smooth(e.lens_v[i]) * smooth(e.time_u[i]);
            }
            sum += std::pow(total / spp - 1, 2);
        }
    }
    return std::sqrt(sum / (pixels * seeds));
}

// An RMSE from N = 2048 squared normal errors has a relative error of 1 / sqrt(2 N) = 0.016. The slope over a
// factor of 64 in spp is the log of a ratio of two RMSEs divided by log 64 = 4.16, with an error of 0.0053.
// The tolerance is 4.5 of these, 0.024.
TEST(SamplerConvergence, SlopesOfTheError) {
    const auto slope = [](SamplerKind kind) {
        return std::log(rmse(kind, 16) / rmse(kind, 1024)) / std::log(64.0);
    };
    EXPECT_NEAR(slope(SamplerKind::random), 0.5, 0.024);
    const double sobol = slope(SamplerKind::sobol), jittered = slope(SamplerKind::jittered);
    EXPECT_GT(sobol, 0.7 + 0.024);
    EXPECT_GT(jittered, 0.5 - 0.024);
    EXPECT_LT(jittered, sobol);
    // The variance for independent points is m^5 - 1 with m = 1 + 0.8^2 / 12, as for a product of five
    // factors.
    const double sigma = std::sqrt(std::pow(1 + 0.64 / 12, 5) - 1);
    EXPECT_NEAR(rmse(SamplerKind::random, 64) / (sigma / 8), 1, 4.5 * 0.016);
    for (const int spp : {16, 256}) {
        const double random = rmse(SamplerKind::random, spp);
        EXPECT_LT(rmse(SamplerKind::jittered, spp), 0.75 * random);
        EXPECT_LT(rmse(SamplerKind::poisson, spp), 0.75 * random);
        EXPECT_LT(rmse(SamplerKind::sobol, spp), rmse(SamplerKind::jittered, spp));
    }
}

}  // namespace
}  // namespace postlens::test::sampler_test
