// The fast form of the layers method against the reference form, for any lens and number of threads.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/job.h"
#include "focus/layers/layers.h"
#include "focus/layers/visibility.h"
#include "focus/scatter/pixel_light.h"
#include "records/record.h"
#include "tests/focus/focus_records.h"
#include "tests/focus/layer_records.h"
#include "tests/support/random_records.h"

namespace postlens::test::layers_reference_test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Random records of interpenetrating objects, mirrors, hidden layers, and hidden nodes after bounces.
RecordBand tangle(std::mt19937& random, int overscan_px, int width, int height) {
    RecordBand band =
        random_band(random, -overscan_px, width + overscan_px + 1, -overscan_px, height + overscan_px + 1,
                    {.levels = 2, .probability = 0.3, .has_w = true, .has_layers = true});
    for (Record& r : band.records) {
        r.id = (r.id + static_cast<std::uint32_t>(std::abs(r.x) / 9)) % 5;
        if (r.layer == 1 && r.id == 3) r.path = reflected_path;
    }
    return band;
}

TEST(Layers, EqualsTheReference) {
    std::mt19937 random(41);
    for (const double scale : {1e-6, 0.3, 3.0, 40.0}) {
        const RecordBand band = tangle(random, 4, 51, 46);
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px *= scale;
        geometry.inverse_focus_per_m = 0.3;
        // The depths that the models use differ, but not what is done with them.
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            if (model != DepthModel::ray_differentials && scale != 3) continue;
            const auto splats = splats_of(band, 4, {.geometry = geometry, .model = model});
            Image fast;
            layers(*splats, fast);
            // Tolerance: sums of 1e4 terms in another order, for colours of up to 4.
            EXPECT_LT(difference(fast, layers_reference(*splats)), 2e-5) << scale;
        }
    }
}

TEST(Layers, EqualsTheReferenceForOtherApertures) {
    std::mt19937 random(43);
    const RecordBand band = tangle(random, 4, 40, 30);
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px *= 6;
    geometry.inverse_focus_per_m = 0.3;
    std::vector<Impulse> impulses(3);
    impulses[0].kind = ImpulseKind::polygon;
    impulses[0].blades = 5;
    impulses[1] = impulses[0];
    impulses[1].cats_eye = 0.8;
    impulses[2].kind = ImpulseKind::diffraction;
    for (const Impulse& impulse : impulses) {
        const std::shared_ptr<const ResponseModel> response = response_model(impulse, geometry, 25);
        const bool diffracts = impulse.kind == ImpulseKind::diffraction;
        // Both forms use the same kernels. The kernels of diffraction are slow to make, so fewer are made.
        const auto depths = diffracts ? std::optional<int>(8) : std::nullopt;
        const auto splats = splats_of(band, 4, {.geometry = geometry, .depths = depths}, response);
        EXPECT_EQ(splats->kernels().channels(), diffracts ? 3U : 1U);
        Image fast;
        layers(*splats, fast);
        EXPECT_LT(difference(fast, layers_reference(*splats)), 2e-5) << impulse_text(impulse);
    }
}

// Pixels of another program's image: a slanted wall behind a window frame, whose pixels share a kernel in
// runs of all lengths. One pixel is very bright.
TEST(Layers, OfPixelsThatShareKernelsEqualsTheReference) {
    constexpr int width = 150, height = 50, overscan = 9;
    for (const double scale : {0.05, 1.0, 8.0, 60.0}) {
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px *= scale;
        geometry.inverse_focus_per_m = 0.3;
        const RasterWindow source{-overscan, width + overscan + 1, -overscan, height + overscan + 1};
        LayerSplats splats(source, {0, width, 0, height}, geometry,
                           DepthLevels(geometry, {}, DepthSpacing::inverse, std::nullopt), DepthModel::path);
        splats.take_pixels(source);
        std::mt19937 random(45);
        std::uniform_real_distribution<float> colour(0, 1);
        std::vector<PixelLight> row;
        for (int y = source.y_begin; y < source.y_end - 1; ++y) {
            row.clear();
            for (int x = source.x_begin; x < source.x_end - 1; ++x) {
                const bool is_frame = x % 40 < 11 || y % 23 < 4;
                const double inverse_depth = is_frame ? 0.8 : 0.1 + 1e-4 * x + 0.002 * y;
                const float bright = x == 70 && y == 20 ? 3000 : 1;
                row.push_back({.x = x,
                               .inverse_depth = inverse_depth,
                               .spread_depth = inverse_depth,
                               .rgb = {bright * colour(random), colour(random), colour(random)},
                               .surface = is_frame ? 2U : 1U});
            }
            splats.add_pixels(y, row);
        }
        splats.finish();
        Image fast;
        layers(splats, fast);
        const Image reference = layers_reference(splats);
        float difference = 0;  // of each value in relation to itself, because the bright pixel has large ones
        for (std::size_t i = 0; i < fast.rgb.size(); ++i)
            difference =
                std::max(difference, std::abs(fast.rgb[i] - reference.rgb[i]) / (1 + reference.rgb[i]));
        EXPECT_LT(difference, 2e-5F) << scale;
    }
}

TEST(Layers, IsTheSameBitsForAnyNumberOfThreads) {
    std::mt19937 random(47);
    const RecordBand band = tangle(random, 4, 140, 130);
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px *= 4;
    geometry.inverse_focus_per_m = 0.3;
    std::vector<Image> images;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        images.push_back(layered(band, 4, {.geometry = geometry}));
    }
    EXPECT_EQ(images[0].rgb, images[1].rgb);
}

TEST(Layers, AnyLensGivesFinitePicturesBetweenTheDarkestAndTheBrightest) {
    std::mt19937 random(53);
    const RecordBand band = tangle(random, 2, 24, 16);
    std::array<float, 3> most{};
    // Sums the visible nodes of each sample with all reflected ones. Hidden nodes after bounces are added to
    // the nodes in front of them.
    for (std::size_t k = 0; k + 1 < band.offsets.size(); ++k) {
        for (std::size_t i = band.offsets[k]; i < band.offsets[k + 1]; ++i) {
            std::array<float, 3> sum{};
            const Record& first = band.records[i];
            for (std::size_t j = i; j < band.offsets[k + 1]; ++j) {
                const Record& r = band.records[j];
                if (r.x == first.x && r.y == first.y && r.layer == first.layer) {
                    sum = {sum[0] + r.r, sum[1] + r.g, sum[2] + r.b};
                }
            }
            for (std::size_t c = 0; c < 3; ++c) most[c] = std::max(most[c], sum[c]);
        }
    }
    for (const double f_number : {0.5, 1.4, 8.0, 64.0}) {
        for (const double focus_m : {0.1, 0.7, 3.0, 1e6, static_cast<double>(infinity)}) {
            // These settings make CoCs of up to four image widths.
            const FocusGeometry geometry{.aperture_radius_m = 0.025 / f_number,
                                         .inverse_focus_per_m = 1 / focus_m,
                                         .gain_px = 200,
                                         .zoom = 1};
            const Image image = layered(band, 2, {.geometry = geometry});
            for (std::size_t i = 0; i < image.rgb.size(); ++i) {
                ASSERT_TRUE(std::isfinite(image.rgb[i])) << f_number << " " << focus_m;
                ASSERT_GE(image.rgb[i], 0) << f_number << " " << focus_m;
                ASSERT_LE(image.rgb[i], most[i % 3]) << f_number << " " << focus_m;
            }
        }
    }
}

TEST(Composite, LiesOver) {
    // Without moments and far apart in depth, alphas are multiplied.
    const FocusGeometry geometry{
        .aperture_radius_m = 1e-3, .inverse_focus_per_m = 10, .gain_px = 1000, .zoom = 1};
    const auto fragment = [](double inverse_m, double seen, double hidden, double grey, double covered = 0) {
        Fragment f{.inverse_depth_per_m = inverse_m, .seen = {}, .hidden = {}};
        f.seen.alpha = seen;
        f.hidden.alpha = hidden;
        f.seen.rgb.fill(seen * grey);
        f.hidden.rgb.fill(hidden * grey);
        f.covered = covered;
        return f;
    };
    std::vector<Fragment> two{fragment(0, 0.5, 0.5, 1), fragment(40, 0.3, 0, 4)};
    EXPECT_NEAR(composite(two, geometry)[0], 0.3 * 4 + 0.7, 1e-12);
    std::vector<Fragment> three{fragment(-100, 1, 0, 8), fragment(0, 0.5, 0, 1), fragment(40, 0.3, 0, 4)};
    EXPECT_NEAR(composite(three, geometry)[0], 0.3 * 4 + 0.7 * (0.5 + 0.5 * 8), 1e-12);
    // With equal CoCs, only the visible parts count, not the hidden ones.
    std::vector<Fragment> together{fragment(20, 0.5, 0.5, 1, 0.5), fragment(20.001, 0.25, 0, 4),
                                   fragment(20, 0.25, 0, 2)};
    EXPECT_NEAR(composite(together, geometry)[0], 0.25 * 4 + 0.25 * 2 + 0.5, 1e-3);
    // If nothing is recorded behind a fragment, the result is divided by its coverage.
    std::vector<Fragment> half{fragment(20, 0.5, 0, 3)};
    EXPECT_NEAR(composite(half, geometry)[0], 3, 1e-12);
    EXPECT_EQ(composite({}, geometry), (std::array<double, 3>{}));
}

TEST(Composite, IsNoBrighterThanItsSurfacesWhereHardlyAnyAlphaArrives) {
    const FocusGeometry geometry{
        .aperture_radius_m = 1e-3, .inverse_focus_per_m = 10, .gain_px = 1000, .zoom = 1};
    // A black surface covers nine tenths of the lens, the right side first.
    Fragment front{.inverse_depth_per_m = 40, .seen = {}, .hidden = {}};
    front.seen.alpha = 0.9;
    front.seen.lens.alpha = {0.09, 0};
    // The one behind it is white. Its alpha lies on the right, its light all over the lens.
    Fragment behind{.inverse_depth_per_m = 0, .seen = {}, .hidden = {}};
    behind.hidden.alpha = 1;
    behind.hidden.rgb.fill(1);
    behind.hidden.lens.alpha = {0.277, 0};
    std::vector<Fragment> both{front, behind};
    // A tenth of the light arrives, and of the rest as much as the tenth of the lens that is open.
    EXPECT_NEAR(composite(both, geometry)[0], 0.1 + 0.9 * 0.1, 1e-3);
}

}  // namespace
}  // namespace postlens::test::layers_reference_test
