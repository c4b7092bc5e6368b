// From a scene to a focused image: properties of all parts together.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/threads.h"
#include "focus/focus.h"
#include "lens/ellipse_coverage.h"
#include "tests/support/refusal.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/trace.h"

namespace postlens::test::pipeline_test {
namespace {

namespace fs = std::filesystem;
constexpr double infinity = std::numeric_limits<double>::infinity();

// Mirrors and glass in front of a checkered wall.
SceneBuilder busy_scene() {
    SceneBuilder b;
    Material m = matte({0.6, 0.5, 0.4});
    m.reflection = glm::dvec3(0.3);
    b.add(Sphere{{-0.4, 0, -4}, 0.6}, m);
    Material g = glass(1.5, 0.9);
    g.reflection = glm::dvec3(0.1);
    b.add(Sphere{{0.6, 0.1, -3.5}, 0.4}, g);
    Material wall = matte(glm::dvec3(1));
    wall.colour_texture = std::make_shared<const Texture>(
        Checker{.size = glm::dvec3(0.5), .even = glm::dvec3(0.9), .odd = {0.1, 0.2, 0.4}});
    b.add(square({0.01, 0.02, -9.01}, {0, 0, 1}, 12), wall);
    b.point_light({2, 3, 0}, glm::dvec3(1));
    b.scene.ambient_light = glm::dvec3(0.2);
    return b;
}

double largest_difference(const Image& a, const Image& b) {
    EXPECT_EQ(a.rgb.size(), b.rgb.size());
    double most = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        most = std::max(most, std::abs(static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i])));
    }
    return most;
}

class Pipeline : public testing::Test {
  protected:
    fs::path traced(const Scene& scene, const TraceSettings& settings) {
        const fs::path path = folder_.path() / "frame.exr";
        trace_to_file(scene, settings, path);
        return path;
    }
    TemporaryFolder folder_;
};

TEST_F(Pipeline, PinholePicturesAreOneBitForBit) {
    const SampleFileReader file(
        traced(busy_scene().scene,
               {.camera = {.width = 60, .height = 45}, .subdivision = {.levels = 4}, .overscan_px = 7}));
    ASSERT_TRUE(file.header().has_w);
    const Image stored = file.picture();
    EXPECT_EQ(pinhole_picture(file).rgb, stored.rgb);
    const FocusResult by_method =
        focus_picture(file, {.focus_distance_m = 3, .method = FocusMethod::pinhole});
    EXPECT_EQ(by_method.image.rgb, stored.rgb);
    const FocusResult by_aperture = focus_picture(file, {.lens = {50, infinity}, .focus_distance_m = 3});
    EXPECT_EQ(by_aperture.image.rgb, stored.rgb);
    EXPECT_EQ(by_aperture.method, FocusMethod::pinhole);
}

TEST_F(Pipeline, AsTheCircleVanishesThePictureIsThePinholes) {
    const SampleFileReader file(
        traced(busy_scene().scene,
               {.camera = {.width = 60, .height = 45}, .subdivision = {.levels = 4}, .overscan_px = 7}));
    const Image stored = file.picture();
    for (const double f_number : {1e6, 1e9}) {
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            const FocusResult r =
                focus_picture(file, {.lens = {50, f_number}, .focus_distance_m = 3, .depth_model = model});
            EXPECT_EQ(r.method, FocusMethod::scatter);
            // At f/1e6 the widest CoC is 1e-5 px, and less than that share of a sample crosses a pixel's
            // border.
            EXPECT_LT(largest_difference(r.image, stored), f_number < 1e7 ? 5e-5 : 1e-6);
        }
    }
}

TEST_F(Pipeline, TheSameBitsForAnyNumberOfThreads) {
    const SampleFileReader file(
        traced(busy_scene().scene,
               {.camera = {.width = 120, .height = 90}, .subdivision = {.levels = 3}, .overscan_px = 7}));
    std::vector<Image> images;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        images.push_back(focus_picture(file, {.lens = {50, 1.4}, .focus_distance_m = 3.5}).image);
    }
    EXPECT_EQ(images[0].rgb, images[1].rgb);
}

// For one defocused plane, the focused image is the raster of corners filtered by one disc. The reference is
// OpenCV's filter.
TEST_F(Pipeline, OnePlaneIsAFilterOfTheCorners) {
    SceneBuilder b;
    Material wall = glowing(glm::dvec3(1));
    wall.emission_texture = std::make_shared<const Texture>(
        Checker{.size = glm::dvec3(0.171, 0.133, infinity), .even = {3, 1, 0.2}, .odd = {0.1, 0.4, 0.8}});
    b.add(square({0, 0, -4}, {0, 0, 1}, 40), wall);
    const int width = 160, height = 120, overscan = 24;
    const SampleFileReader file(traced(b.scene, {.camera = {.width = width, .height = height},
                                                 .subdivision = {.levels = 0},
                                                 .overscan_px = overscan}));
    const FocusSettings settings{.lens = {50, 1.4}, .focus_distance_m = 0.5};
    const FocusResult focused = focus_picture(file, settings);

    const FocusGeometry lens = focus_geometry(settings.lens, 0.5, Framing::keep,
                                              {file.header().film_distance_mm, file.header().pixel_pitch_mm});
    const double radius = std::abs(lens.coc_diameter_px(1 / 4.0)) / 2;
    ASSERT_GT(radius, 5);
    ASSERT_LT(radius, overscan - 2);
    // Corner (i, j) is at integer coordinates, so pixel (x, y) gathers corners with the coverage of a disc
    // about (0, 0).
    const int reach = static_cast<int>(std::ceil(radius)) + 1;
    cv::Mat kernel = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_64F);
    for (const CoverageRow& row : ellipse_coverage(Ellipse::disc(radius), 0, 0)) {
        for (std::size_t i = 0; i < row.share.size(); ++i) {
            // filter2D computes a correlation: corner c contributes to pixel p = c + d, so its tap is at -d.
            kernel.at<double>(reach - row.y, reach - (row.x_begin + static_cast<int>(i))) = row.share[i];
        }
    }
    RecordBand band;
    file.read(file.y_begin(), file.y_end(), band);
    cv::Mat corners(band.height(), band.width(), CV_64FC3);
    for (int y = 0; y < band.height(); ++y) {
        for (int x = 0; x < band.width(); ++x) {
            const Record& r = band.records[band.offsets[band.pixel(x + band.x_begin, y + band.y_begin)]];
            corners.at<cv::Vec3d>(y, x) = {static_cast<double>(r.r), static_cast<double>(r.g),
                                           static_cast<double>(r.b)};
        }
    }
    cv::Mat filtered;
    cv::filter2D(corners, filtered, CV_64F, kernel);
    double most = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const cv::Vec3d& expected = filtered.at<cv::Vec3d>(y + overscan, x + overscan);
            for (int c = 0; c < 3; ++c) {
                most =
                    std::max(most, std::abs(expected[c] - static_cast<double>(focused.image.pixel(x, y)[c])));
            }
        }
    }
    // The CoC of the nearest depth level differs from the plane's by less than 0.5 px in diameter. A change
    // of 0.25 px in radius moves at most 2 * 0.25 / radius of a pixel's energy, with a contrast of 2.9.
    EXPECT_LT(most, 2.9 * 2 * 0.25 / radius);
    // With a depth level at the plane, only float rounding remains.
    FocusSettings exact = settings;
    exact.depths = 2;
    most = 0;
    const FocusResult at_level = focus_picture(file, exact);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                most = std::max(most, std::abs(filtered.at<cv::Vec3d>(y + overscan, x + overscan)[c] -
                                               static_cast<double>(at_level.image.pixel(x, y)[c])));
            }
        }
    }
    EXPECT_LT(most, 1e-5);
}

// A mirror at 2 m shows a wall that is 3 m in front of it. With the focus at 5 m the reflected image is
// sharp, with the focus on the mirror it is not.
TEST_F(Pipeline, WhatAMirrorShowsIsInFocusAtItsOwnDepth) {
    SceneBuilder b;
    Material wall = glowing(glm::dvec3(1));
    wall.emission_texture = std::make_shared<const Texture>(
        Checker{.size = glm::dvec3(0.25, 0.25, infinity), .even = glm::dvec3(1), .odd = glm::dvec3(0)});
    b.add(square({0, 0, -2}, {0, 0, 1}, 8), mirror());
    b.add(square({0, 0, 1}, {0, 0, -1}, 40), wall);
    // Without subdivision, the arriving weights are 1 everywhere, for any blur of the mirror itself.
    const SampleFileReader file(traced(
        b.scene, {.camera = {.width = 640, .height = 480}, .subdivision = {.levels = 0}, .overscan_px = 20}));
    const Image pinhole = file.picture();
    const auto at = [&](double focus_m, DepthModel model) {
        return largest_difference(
            focus_picture(file, {.lens = {50, 1.4}, .focus_distance_m = focus_m, .depth_model = model}).image,
            pinhole);
    };
    EXPECT_LT(at(5, DepthModel::ray_differentials), 1e-5);
    EXPECT_LT(at(5, DepthModel::path), 1e-5);  // for a flat mirror the path length is also correct
    EXPECT_GT(at(2, DepthModel::ray_differentials), 0.3);
    EXPECT_LT(at(2, DepthModel::first_hit), 1e-5);  // equals a depth buffer
}

TEST_F(Pipeline, AnOrthographicFileHasNoLens) {
    SceneBuilder b = busy_scene();
    b.scene.cameras[0].projection = Camera::Projection::orthographic;
    b.scene.cameras[0].orthographic_width_m = 3;
    const SampleFileReader file(traced(b.scene, {}));
    EXPECT_EQ(focus_picture(file, {.lens = {50, infinity}, .focus_distance_m = 3}).image.rgb,
              file.picture().rgb);
    expect_refused(
        [&] {
            (void)focus_picture(file, {.lens = {50, 2}, .focus_distance_m = 3});
        },
        ExitCode::wrong_arguments, "orthographic");
}

}  // namespace
}  // namespace postlens::test::pipeline_test
