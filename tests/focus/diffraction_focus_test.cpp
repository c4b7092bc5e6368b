// Focus with diffraction: the image of a point light by the scatter method, compared with its response.
#include <cmath>
#include <gtest/gtest.h>

#include "core/threads.h"
#include "focus/responses/diffraction_model.h"
#include "lens/wave/diffraction_response.h"
#include "lens/wave/wave_scale.h"
#include "tests/focus/focus_records.h"

namespace postlens::test::diffraction_focus_test {
namespace {

// 50 mm on a film of 4 um pixels. At f/8 and f/22 the Airy discs are 2.7 and 7.4 px wide at 550 nm.
FocusGeometry geometry(double f_number) {
    return focus_geometry({50, f_number}, 4, Framing::keep, {50, 0.004});
}

/// A white point at (20, 20) on black, all at one depth.
RecordBand point(double z_m) {
    return corner_band(40, 40, 0, [z_m](int x, int y) {
        const float light = x == 20 && y == 20 ? 100.0F : 0.0F;
        return std::vector<Record>{corner(z_m, light, light, light)};
    });
}

std::unique_ptr<SplatTables> tables(const RecordBand& band, const FocusGeometry& g) {
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end}, picture{0, 40, 0, 40};
    auto out = std::make_unique<SplatTables>(source, picture, g,
                                             DepthLevels(g, {4, 4}, DepthSpacing::inverse, std::nullopt),
                                             DepthModel::ray_differentials, diffraction_model({}, g));
    out->add_rows(band, band.y_begin, band.y_end);
    out->finish();
    return out;
}

// The image of the point is its response, which is wider for red than for blue. The borders of the image
// truncate the weights only within the kernel's radius, not in the middle.
TEST(DiffractionFocus, APointBecomesItsResponse) {
    for (const double f_number : {8.0, 22.0}) {
        const FocusGeometry g = geometry(f_number);
        for (const double z : {4.0, 4.4}) {
            const RecordBand band = point(z);
            Image image;
            scatter(*tables(band, g), image);
            const double coc_px = g.coc_diameter_px(1 / z);
            // The depth level of this CoC has a CoC within 0.5 px of it, half a step of 0.99 px.
            const DepthLevels levels(g, {4, 4}, DepthSpacing::inverse, std::nullopt);
            const double used_px = 2 * levels.radius_px()[*levels.level_of(1 / z)];
            EXPECT_NEAR(used_px, std::abs(coc_px), 0.5);
            const std::vector<double> cocs{used_px};
            const ChannelResponses expected = diffraction_responses(g, cocs, {.max_radius_px = 600})[0];
            for (int c = 0; c < 3; ++c) {
                const ResponseGrid& grid = expected.channel[static_cast<std::size_t>(c)];
                for (int y = 14; y < 26; ++y) {
                    for (int x = 14; x < 26; ++x) {
                        const double share = grid.at(x - 20 - grid.x_begin, y - 20 - grid.y_begin);
                        // Pixels are divided by the sum of the weights that arrive: 1, less up to 5 % from
                        // beyond 14 px.
                        const auto got = static_cast<double>(image.pixel(x, y)[c]) / 100;
                        EXPECT_GE(got, share * 0.999)
                            << f_number << ", " << z << ", " << c << ": " << x << ", " << y;
                        EXPECT_LE(got, share * 1.15 + 1e-7) << f_number << ", " << z << ", " << c;
                    }
                }
            }
            EXPECT_GT(image.pixel(20, 20)[2], z == 4 ? image.pixel(20, 20)[0] : 0.0F);
        }
    }
}

TEST(DiffractionFocus, FastAndSlowFormsAgree) {
    const FocusGeometry g = geometry(16);
    const RecordBand band = corner_band(40, 40, 0, [](int x, int y) {
        const auto f = static_cast<float>((x * 7 + y * 13) % 11);
        return std::vector<Record>{corner(x < 20 ? 4.1 : 3.7, f, 2 * f, f * f)};
    });
    const auto t = tables(band, g);
    Image fast;
    scatter(*t, fast);
    const Image slow = scatter_reference(*t);
    for (std::size_t i = 0; i < fast.rgb.size(); ++i)
        EXPECT_NEAR(fast.rgb[i], slow.rgb[i], 2e-6F * std::max(1.0F, slow.rgb[i]));
}

// Far out of focus and wide open, the response by waves is the disc of geometric optics except at its edge.
TEST(DiffractionFocus, IsTheDiscWhereTheApertureIsWide) {
    const FocusGeometry g = focus_geometry({50, 1.4}, 4, Framing::keep, {50, 0.01875});
    const double z = 10;
    const RecordBand band = point(z);
    Image waves, rays;
    scatter(*tables(band, g), waves);
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end}, picture{0, 40, 0, 40};
    SplatTables discs(source, picture, g, DepthLevels(g, {4, 4}, DepthSpacing::inverse, std::nullopt),
                      DepthModel::ray_differentials);
    discs.add_rows(band, band.y_begin, band.y_end);
    discs.finish();
    scatter(discs, rays);
    const DepthLevels levels(g, {4, 4}, DepthSpacing::inverse, std::nullopt);
    const double radius_px = levels.radius_px()[*levels.level_of(1 / z)];
    ASSERT_GT(radius_px, 6);
    for (int y = 10; y < 30; ++y) {
        for (int x = 10; x < 30; ++x) {
            const double distance = std::hypot(x - 19.5, y - 19.5);
            if (std::abs(distance - radius_px) < 1.6) continue;
            // Fringes for u = 150: 20 % in the middle of the disc, a few per cent elsewhere, averaged over a
            // pixel and three wavelengths.
            const double inside = distance < radius_px ? 1 : 0,
                         even = 100 / (3.14159 * radius_px * radius_px);
            EXPECT_NEAR(static_cast<double>(waves.pixel(x, y)[1]), inside * even, 0.25 * even)
                << x << ", " << y;
            EXPECT_NEAR(static_cast<double>(rays.pixel(x, y)[1]), inside * even, 0.02 * even)
                << x << ", " << y;
        }
    }
}

TEST(DiffractionFocus, SameBitsForAnyNumberOfThreads) {
    const FocusGeometry g = geometry(11);
    Image first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        Image image;
        scatter(*tables(point(4.3), g), image);
        if (threads == 1) first = image;
        EXPECT_TRUE(image.rgb == first.rgb) << threads;
    }
}

}  // namespace
}  // namespace postlens::test::diffraction_focus_test
