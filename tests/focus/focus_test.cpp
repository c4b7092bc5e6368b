// `focus` from a sample file to an image: limiting cases, framing, warnings, errors.
#include "focus/focus.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "core/error.h"
#include "core/threads.h"
#include "focus/reframe.h"
#include "records/quadtree.h"
#include "tests/focus/focus_records.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::focus_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

SampleHeader header_of(const RecordBand& band, int overscan_px) {
    SampleHeader h;
    h.width = band.width() - 1 - 2 * overscan_px;
    h.height = band.height() - 1 - 2 * overscan_px;
    h.overscan_px = overscan_px;
    h.film_distance_mm = 50;
    h.pixel_pitch_mm = 0.05;
    h.focal_length_mm = 50;
    h.subdivide_levels = 10;
    h.max_depth = 17;
    h.scene_name = "test";
    h.scene_sha256 = std::string(64, '0');
    h.object_names = {{1, "thing"}};
    return h;
}

/// Writes the file in bands of rows that differ from those in which it is read.
SampleFileReader written(const TemporaryFolder& folder, const RecordBand& band, const SampleHeader& header) {
    const auto path = folder.path() / "frame.exr";
    SampleFileWriter writer(path, header, RecordCompression::none);
    for (int y = band.y_begin; y < band.y_end; y += 37) {
        writer.write(rows_of_band(band, y, std::min(y + 37, band.y_end)));
    }
    (void)writer.finish();
    return SampleFileReader(path);
}

/// A 50 mm lens at f/2, with pixels of 0.05 mm at a film distance of 50 mm. The CoC is 25 px m |1/s - 1/z'|.
constexpr ThinLens fast_lens{.focal_length_mm = 50, .f_number = 2};

// --- limits
// --------------------------------------------------------------------------------------------------------

TEST(FocusPicture, PinholeIsTheTracedPictureBitForBit) {
    const TemporaryFolder folder;
    std::mt19937 random(1);
    const RandomOptions options{.levels = 4, .probability = 0.3, .has_w = true, .has_layers = true};
    SampleHeader header = full_header(60, 150, 4, options);
    header.moving_ids.clear();
    header.motion = {};
    const RecordBand band = random_frame(random, header, options);
    const SampleFileReader file = written(folder, band, header);
    Image expected(60, 150);
    for (int y = 0; y < 150; ++y) picture_row(band, y, 0, 60, {expected.pixel(0, y), 180});

    const FocusResult by_method = focus_picture(file, {.lens = fast_lens, .method = FocusMethod::pinhole});
    const FocusResult by_aperture =
        focus_picture(file, {.lens = {.focal_length_mm = 50, .f_number = infinity}});
    for (const FocusResult* result : {&by_method, &by_aperture}) {
        EXPECT_EQ(result->image.rgb, expected.rgb);
        EXPECT_EQ(result->method, FocusMethod::pinhole);
        EXPECT_EQ(result->depths, 0);
        EXPECT_TRUE(result->warnings.empty());
    }
    EXPECT_EQ(pinhole_picture(file).rgb, expected.rgb);
    EXPECT_EQ(file.picture().rgb, expected.rgb);
}

TEST(FocusPicture, TendsToTheTracedPicture) {
    const TemporaryFolder folder;
    std::mt19937 random(2);
    const RandomOptions options{.levels = 3, .probability = 0.4, .has_w = true, .has_layers = true};
    SampleHeader header = full_header(50, 140, 2, options);
    header.moving_ids.clear();
    header.motion = {};
    const SampleFileReader file = written(folder, random_frame(random, header, options), header);
    const Image expected = pinhole_picture(file);
    for (const DepthModel model : {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
        for (const auto depths : {std::optional<int>(), std::optional<int>(9)}) {
            const FocusResult result = focus_picture(
                file,
                {.lens = {.focal_length_mm = 50, .f_number = 1e9}, .depth_model = model, .depths = depths});
            EXPECT_EQ(result.method, FocusMethod::scatter);
            EXPECT_LT(result.largest_coc_px, 1e-3);
            for (std::size_t i = 0; i < expected.rgb.size(); ++i) {
                const auto wanted = static_cast<double>(expected.rgb[i]);
                ASSERT_NEAR(static_cast<double>(result.image.rgb[i]), wanted, 1e-6 * std::max(1.0, wanted))
                    << i;
            }
        }
    }
}

TEST(FocusPicture, WhatIsInFocusStaysSharp) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> colour(0, 1);
    const RecordBand band = corner_band(40, 30, 0, [&](int, int) {
        return std::vector{corner(3, colour(random), colour(random), colour(random))};
    });
    const SampleFileReader file = written(folder, band, header_of(band, 0));
    const FocusResult result = focus_picture(file, {.lens = fast_lens, .focus_distance_m = 3});
    EXPECT_LT(difference(result.image, pinhole_picture(file)), 1e-6);
    EXPECT_EQ(result.depths, 1);
    EXPECT_LT(result.largest_coc_px, 1e-3);
    EXPECT_TRUE(result.warnings.empty());
}

TEST(FocusPicture, EqualsTheScatterOfTheWholeBand) {
    // Reading the file in bands of rows must not change the image.
    const TemporaryFolder folder;
    std::mt19937 random(4);
    const RandomOptions options{.levels = 2, .probability = 0.3, .has_w = true};
    RecordBand band = random_band(random, -5, 26, -5, 186, options);
    SampleHeader header = header_of(band, 5);
    header.has_w = true;
    header.object_names.clear();
    const SampleFileReader file = written(folder, band, header);
    const FocusGeometry geometry = focus_geometry(fast_lens, 2, Framing::keep, {50, 0.05});
    for (const DepthSpacing spacing : {DepthSpacing::inverse, DepthSpacing::linear}) {
        const FocusResult result =
            focus_picture(file, {.lens = fast_lens, .focus_distance_m = 2, .spacing = spacing, .depths = 24});
        const auto tables = tables_of(band, 5, {.geometry = geometry, .spacing = spacing, .depths = 24});
        Image expected;
        scatter(*tables, expected);
        EXPECT_EQ(result.image.rgb, expected.rgb);
        EXPECT_EQ(result.depths, 24);
        EXPECT_EQ(result.largest_coc_px, tables->largest_coc_px());
    }
}

TEST(FocusPicture, FocusAtInfinityAndInsideTheFocalLengthAreLegal) {
    const TemporaryFolder folder;
    const RecordBand band = corner_band(40, 30, 0, [](int x, int) {
        return std::vector{corner(x < 20 ? 1e-6 : infinity, 0.5F, 0.25F, 1.0F)};
    });
    const SampleFileReader file = written(folder, band, header_of(band, 0));
    for (const double s_m : {infinity, 0.05, 0.03, 1e-6}) {
        const FocusResult result = focus_picture(file, {.lens = fast_lens, .focus_distance_m = s_m});
        for (std::size_t i = 0; i < result.image.rgb.size(); i += 3) {
            ASSERT_NEAR(result.image.rgb[i], 0.5F, 1e-6) << s_m;
            ASSERT_NEAR(result.image.rgb[i + 1], 0.25F, 1e-6);
            ASSERT_NEAR(result.image.rgb[i + 2], 1.0F, 1e-6);
        }
        EXPECT_TRUE(std::isfinite(result.largest_coc_px));
    }
}

TEST(FocusPicture, IsTheSameForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    std::mt19937 random(5);
    const RandomOptions options{.levels = 2, .probability = 0.2, .has_w = true};
    RecordBand band = random_band(random, -3, 74, -3, 104, options);
    SampleHeader header = header_of(band, 3);
    header.has_w = true;
    header.object_names.clear();
    const SampleFileReader file = written(folder, band, header);
    std::vector<float> first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const FocusResult result = focus_picture(file, {.lens = fast_lens, .focus_distance_m = 1.5});
        if (first.empty()) first = result.image.rgb;
        EXPECT_EQ(result.image.rgb, first) << threads;
    }
}

// --- warnings
// ----------------------------------------------------------------------------------------------------------

TEST(FocusPicture, WarnsOfMissingOverscan) {
    const TemporaryFolder folder;
    // The left third has a CoC of 25 |1/2 - 1| = 12.5 px; the rest is in focus.
    const auto nodes = [](int x, int) { return std::vector{corner(x < 30 ? 1 : 2, 0.5F, 0.5F, 0.5F)}; };
    const FocusSettings settings{.lens = fast_lens, .focus_distance_m = 2};
    const RecordBand bare = corner_band(90, 60, 0, nodes);
    const FocusResult result = focus_picture(written(folder, bare, header_of(bare, 0)), settings);
    EXPECT_NEAR(result.largest_coc_px, 12.5, 1e-5);
    ASSERT_EQ(result.warnings.size(), 1U);
    EXPECT_EQ(result.warnings[0].code, "overscan");
    // The radius of 6.25 px affects 7 rows at the top and bottom of the blurred third (and the pixel in which
    // it ends), and 7 columns at the left.
    const double expected = (7 * 60 + (30 - 7) * 14) / (90.0 * 60);
    EXPECT_NEAR(result.warnings[0].share, expected, 14 / (90.0 * 60));
    EXPECT_NE(result.warnings[0].text.find("got 0 px of overscan; expected 7 px"), std::string::npos)
        << result.warnings[0].text;

    const RecordBand enough = corner_band(90, 60, 7, nodes);
    EXPECT_TRUE(focus_picture(written(folder, enough, header_of(enough, 7)), settings).warnings.empty());
    const RecordBand some = corner_band(90, 60, 4, nodes);
    const FocusResult partly = focus_picture(written(folder, some, header_of(some, 4)), settings);
    ASSERT_EQ(partly.warnings.size(), 1U);
    EXPECT_LT(partly.warnings[0].share, expected / 2);
    EXPECT_NE(partly.warnings[0].text.find("got 4 px of overscan; expected 7 px"), std::string::npos);
}

TEST(FocusPicture, WarnsOfMissingOverscanForAberrations) {
    const TemporaryFolder folder;
    // Everything is in focus, so the aberration alone moves light: 12.5 px at the rim of the lens.
    const RecordBand band =
        corner_band(90, 60, 0, [](int, int) { return std::vector{corner(2, 0.5F, 0.5F, 0.5F)}; });
    const SampleFileReader file = written(folder, band, header_of(band, 0));
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusResult result = focus_picture(
            file, {.lens = fast_lens, .focus_distance_m = 2, .method = method, .impulse = {.spherical = 1}});
        ASSERT_FALSE(result.warnings.empty());
        EXPECT_EQ(result.warnings[0].code, "overscan");
        EXPECT_NE(result.warnings[0].text.find("got 0 px of overscan; expected 13 px"), std::string::npos)
            << result.warnings[0].text;
    }
}

TEST(FocusPicture, TheWidestCircleIsOfWhatWasHitByEveryMethod) {
    const TemporaryFolder folder;
    // A surface at 2.5 m has a CoC of 25 |1/2 - 1/2.5| = 2.5 px. The background at infinity, without records,
    // would have one of 12.5 px.
    const RecordBand band = corner_band(60, 40, 0, [](int x, int) {
        return std::vector{x < 30 ? corner(2.5, 0.5F, 0.5F, 0.5F) : corner(infinity, 0, 0, 0)};
    });
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
        FocusSettings settings{.lens = fast_lens, .focus_distance_m = 2};
        settings.method = method;
        const FocusResult result = focus_picture(written(folder, band, header_of(band, 0)), settings);
        EXPECT_NEAR(result.largest_coc_px, 2.5, 1e-5) << static_cast<int>(method);
    }
}

TEST(FocusPicture, BlurInTheMiddleNeedsNoOverscan) {
    const TemporaryFolder folder;
    const RecordBand band = corner_band(90, 60, 0, [](int x, int y) {
        return std::vector{corner(x > 30 && x < 60 && y > 20 && y < 40 ? 0.5 : 2, 0.5F, 0.5F, 0.5F)};
    });
    const FocusResult result =
        focus_picture(written(folder, band, header_of(band, 0)), {.lens = fast_lens, .focus_distance_m = 2});
    EXPECT_GT(result.largest_coc_px, 30);
    EXPECT_TRUE(result.warnings.empty());
}

// --- framing
// -----------------------------------------------------------------------------------------------------------

TEST(Reframe, KeepsThePictureAtZoomOne) {
    std::mt19937 random(6);
    std::uniform_real_distribution<float> colour(0, 1);
    Image image(31, 20);
    for (float& v : image.rgb) v = colour(random);
    const RasterWindow window = window_for_zoom(31, 20, 1);
    EXPECT_EQ(window.x_begin, 0);
    EXPECT_EQ(window.x_end, 31);
    EXPECT_EQ(window.y_begin, 0);
    EXPECT_EQ(window.y_end, 20);
    EXPECT_EQ(reframe(image, window, 31, 20, 1).rgb, image.rgb);
}

TEST(Reframe, KeepsEvenAreasEdgesAndEnergy) {
    for (const double zoom : {0.5, 0.8, 1.25, 1.7, 4.0}) {
        const RasterWindow window = window_for_zoom(60, 40, zoom);
        Image traced(window.width(), window.height());
        double energy = 0;
        for (int y = 0; y < traced.height; ++y) {
            for (int x = 0; x < traced.width; ++x) {
                float* p = traced.pixel(x, y);
                p[0] = 0.3F;
                // The green channel has an edge 5 traced pixels right of the centre.
                p[1] = x + window.x_begin >= 35 ? 1.0F : 0.0F;
                // The blue channel has a light inside the frame.
                p[2] = x + window.x_begin == 31 && y + window.y_begin == 18 ? 7.0F : 0.0F;
            }
        }
        const Image out = reframe(traced, window, 60, 40, zoom);
        ASSERT_EQ(out.width, 60);
        ASSERT_EQ(out.height, 40);
        for (int x = 0; x < 60; ++x) {
            EXPECT_NEAR(value(out, x, 20, 0), 0.3F, 1e-7);
            // The expected value is a box filter of a step at 30 + 5 zoom.
            EXPECT_NEAR(value(out, x, 20, 1), std::clamp(x + 1 - (30 + 5 * zoom), 0.0, 1.0), 1e-6)
                << zoom << " " << x;
        }
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 60; ++x) energy += value(out, x, y, 2);
        }
        EXPECT_NEAR(energy, 7 * zoom * zoom, 1e-5);
    }
}

TEST(FocusPicture, FramingZoomsAboutTheCentreAndKeepsTheCocOnTheFilm) {
    const TemporaryFolder folder;
    constexpr double z_m = 1, s_m = 2;
    const RecordBand band = corner_band(
        120, 30, 60, [&](int x, int) { return std::vector{corner(z_m, x >= 64 ? 1.0F : 0.0F, 0.5F, 0)}; });
    const SampleFileReader file = written(folder, band, header_of(band, 60));
    for (const double zoom : {0.5, 1.0, 1.7}) {
        const ThinLens lens{.focal_length_mm = 50 * zoom, .f_number = 2};
        const FocusResult result = focus_picture(
            file, {.lens = lens, .focus_distance_m = s_m, .framing = Framing::lens, .depths = 2});
        // With the film at F, the radius of the CoC is (F / pitch) (F / 2n) |1/s - 1/z|.
        const double radius = 50 * zoom / 0.05 * (0.05 * zoom / 4) * std::abs(1 / s_m - 1 / z_m);
        EXPECT_NEAR(result.largest_coc_px, 2 * radius, 1e-6);
        const double edge = 60 + zoom * (63.5 - 60);
        for (int x = 0; x < 120; ++x) {
            EXPECT_NEAR(value(result.image, x, 15, 1), 0.5, 1e-6);
            const double t = (x + 0.5 - edge) / radius;
            const double wanted = t <= -1 ? 0
                                  : t >= 1
                                      ? 1
                                      : 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
            // Tolerance, relative to the radius: the box of a pixel, traced or in the image, and half a
            // traced pixel between the corners and their squares.
            EXPECT_NEAR(value(result.image, x, 15, 0), wanted, 1.2 * std::max(1.0, zoom) / radius / 2)
                << zoom << " " << x;
        }
    }
}

TEST(FocusPicture, BreathingZoomsByTheImageDistance) {
    const TemporaryFolder folder;
    const RecordBand band = corner_band(
        100, 20, 0, [](int x, int) { return std::vector{corner(0.25, x >= 70 ? 1.0F : 0.0F, 0.5F, 0)}; });
    const SampleFileReader file = written(folder, band, header_of(band, 0));
    const FocusResult result =
        focus_picture(file, {.lens = fast_lens, .focus_distance_m = 0.25, .framing = Framing::breathing});
    // The magnification is V / F = s / (s - F) = 1.25. The edge lies between corners 69 and 70.
    const double edge = 50 + 1.25 * (69.5 - 50);
    double bright = 0;
    for (int x = 0; x < 100; ++x) bright += value(result.image, x, 10, 0);
    EXPECT_NEAR(100 - bright, edge, 1e-4);
    EXPECT_NEAR(value(result.image, 10, 10, 1), 0.5, 1e-6);
    EXPECT_TRUE(result.warnings.empty());
    const FocusResult pinhole = focus_picture(file, {.lens = fast_lens,
                                                     .focus_distance_m = 0.25,
                                                     .framing = Framing::breathing,
                                                     .method = FocusMethod::pinhole});
    EXPECT_LT(difference(pinhole.image, result.image), 1e-6);
}

// --- refusals
// ------------------------------------------------------------------------------------------------------------

std::string refusal(const SampleFileReader& file, const FocusSettings& settings) {
    try {
        (void)focus_picture(file, settings);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::wrong_arguments);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        return e.what();
    }
    return {};
}

TEST(FocusPicture, RefusesWhatIsOutOfRangeWithTheReason) {
    const TemporaryFolder folder;
    const RecordBand band = corner_band(20, 10, 0, [](int, int) { return std::vector{corner(2, 1, 1, 1)}; });
    const SampleFileReader file = written(folder, band, header_of(band, 0));
    const auto expect = [&](const FocusSettings& settings, const std::string& reason) {
        const std::string text = refusal(file, settings);
        EXPECT_NE(text.find(reason), std::string::npos) << "'" << text << "' lacks '" << reason << "'";
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect({.lens = {.focal_length_mm = 0, .f_number = 2}}, "focal length is out of range (got 0 mm;");
    expect({.lens = {.focal_length_mm = nan, .f_number = 2}}, "focal length is out of range (got nan mm;");
    expect({.lens = {.focal_length_mm = 50, .f_number = -2}}, "f-number is out of range (got -2;");
    expect({.lens = fast_lens, .focus_distance_m = 0}, "focus distance is out of range (got 0 m;");
    expect({.lens = fast_lens, .focus_distance_m = -1}, "focus distance is out of range (got -1 m;");
    expect({.lens = fast_lens, .depths = 1}, "number of depths is out of range (got 1;");
    for (const Framing framing : {Framing::lens, Framing::breathing}) {
        expect({.lens = fast_lens, .focus_distance_m = 0.04, .framing = framing}, "within the focal length");
    }
    expect({.lens = {.focal_length_mm = 35, .f_number = 2}, .framing = Framing::lens},
           "field of view is too narrow for this framing (got a film at 35 mm; expected 50 mm or more");
    EXPECT_EQ(refusal(file, {.lens = {.focal_length_mm = 35, .f_number = 2}}), "");
}

TEST(FocusPicture, RefusesALensBeforeAnOrthographicFile) {
    const TemporaryFolder folder;
    const RecordBand band = corner_band(20, 10, 0, [](int, int) { return std::vector{corner(2, 1, 1, 1)}; });
    SampleHeader header = header_of(band, 0);
    header.projection = Projection::orthographic;
    header.film_distance_mm = 0;
    const SampleFileReader file = written(folder, band, header);
    EXPECT_NE(refusal(file, {.lens = fast_lens}).find("orthographic"), std::string::npos);
    const ThinLens pinhole{.focal_length_mm = 50, .f_number = infinity};
    EXPECT_NE(refusal(file, {.lens = pinhole, .framing = Framing::lens}).find("orthographic"),
              std::string::npos);
    EXPECT_EQ(focus_picture(file, {.lens = pinhole}).image.rgb, std::vector<float>(600, 1.0F));
    EXPECT_EQ(focus_picture(file, {.lens = fast_lens, .method = FocusMethod::pinhole}).image.rgb,
              std::vector<float>(600, 1.0F));
}

}  // namespace
}  // namespace postlens::test::focus_test
