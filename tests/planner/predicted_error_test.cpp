// Errors of images that are predicted from their records, against the true errors.
#include "planner/predicted_error.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/error.h"
#include "core/threads.h"
#include "motionblur/motion_blur.h"
#include "pictures/srgb.h"
#include "tests/planner/bar_scene.h"
#include "tests/support/motion_frame.h"
#include "tracer/render.h"

namespace postlens::test::predicted_error_test {
namespace {

using glm::dvec3;

/// A wall of random patches, which favours no set of views, and a near bar on the left that moves by `move_m`
/// in one second.
SceneBuilder bar_and_patches(double move_m = 0) {
    SceneBuilder b;
    Object& bar = b.add(board(-0.34, -0.27, -2, 2, 1), glowing({0.9, 0.2, 0.1}));
    if (move_m != 0) bar.keys = from_to({move_m, 0, 0});
    std::mt19937 random(1);
    std::uniform_real_distribution<double> side(0.2, 0.7), colour(0.1, 0.9);
    for (double y = -6; y < 6;) {
        const double height = side(random);
        for (double x = -8; x < 8;) {
            const double width = side(random);
            b.add(board(x, x + width, y, y + height, 10),
                  glowing({colour(random), colour(random), colour(random)}))
                .id = 2;
            x += width;
        }
        y += height;
    }
    b.scene.sha256 = std::string(64, 'a');
    return b;
}

FocusSettings with(FocusMethod method, int views = default_lens_views) {
    return {.lens = wide, .focus_distance_m = 3, .method = method, .views = views};
}

/// The noise of 1024 rays per pixel is at 60 dB or lower, measured for each scene here.
Image rays(const Scene& scene, const FocusSettings& focus, const std::optional<TimeSpan>& shutter = {}) {
    RenderSettings s;
    s.focal_length_mm = wide.focal_length_mm;
    s.f_number = focus.lens.f_number;
    s.focus_m = focus.focus_distance_m;
    s.shutter = shutter;
    s.spp = 1024;
    return render_picture(scene, s).image;
}

/// PSNR of the encoded pixels in `crop`.
double is_db(const Image& image, const Image& truth, const std::optional<Crop>& crop = {}) {
    double sum = 0, count = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (crop && !crop->contains(x, y)) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double d = static_cast<double>(srgb_from_linear(image.pixel(x, y)[c])) -
                                 static_cast<double>(srgb_from_linear(truth.pixel(x, y)[c]));
                sum += d * d;
                ++count;
            }
        }
    }
    return -10 * std::log10(sum / count);
}

double expected_db(const SampleFileReader& file, const FocusSettings& focus, const Image& image) {
    FocusFrame frame(file);
    return predict_error(frame, {.focus = focus}, image, focus.views).predicted_db;
}

// Tolerance: a factor of two in squared error. Chance correlations between the image and the two halves of
// its reference are not predicted; they limit the test to 47 dB.
constexpr double factor_of_two_db = 3.01, told_db = 47;

void expect_near(double expected_db, double is_db, const std::string& what) {
    EXPECT_LT(std::min(expected_db, told_db), is_db + factor_of_two_db) << what;
    EXPECT_GT(expected_db, std::min(is_db, told_db) - factor_of_two_db) << what;
}

TEST(PredictError, OfEveryMethodIsWhatThePictureIsOffBy) {
    const SceneBuilder b = bar_and_patches();
    const TracedFrame frame(b.scene, traced(true, 5));
    const Image truth = rays(b.scene, with(FocusMethod::scatter));
    double least = 100, most = 0;
    for (const FocusSettings& f :
         {with(FocusMethod::scatter), with(FocusMethod::layers), with(FocusMethod::lightfield, 16),
          with(FocusMethod::lightfield, 64), with(FocusMethod::lightfield, 256)}) {
        const Image image = focus_picture(frame.file(), f).image;
        const double is = is_db(image, truth), expected = expected_db(frame.file(), f, image);
        expect_near(expected, is, std::to_string(static_cast<int>(f.method)) + " " + std::to_string(f.views));
        least = std::min(least, expected);
        most = std::max(most, expected);
    }
    EXPECT_GT(most, least + 10);
}

TEST(PredictError, KnowsAWrongPictureFromARightOne) {
    const SceneBuilder b = bar_and_patches();
    const TracedFrame frame(b.scene, traced(true, 5));
    const FocusSettings f = with(FocusMethod::layers);
    Image image = focus_picture(frame.file(), f).image;
    const double right = expected_db(frame.file(), f, image);
    for (float& v : image.rgb) v = linear_from_srgb(srgb_from_linear(v) + 0.05F);
    // An error of 0.05 is 26 dB, in addition to the previous error.
    EXPECT_GT(right, 35);
    EXPECT_NEAR(expected_db(frame.file(), f, image),
                -10 * std::log10(0.05 * 0.05 + std::pow(10, -right / 10)), 0.3);
}

TEST(PredictError, BoundsWhatTheRecordsLack) {
    const SceneBuilder b = bar_and_patches();
    FocusSettings f = with(FocusMethod::lightfield, 256);
    f.focus_distance_m = 10;  // blurs the edge of the bar widely
    const Image truth = rays(b.scene, f);
    double least_unsure = 0;
    // Fine records with hidden surfaces, coarse records with them, and records without hidden surfaces.
    for (const TraceSettings& t : {traced(true, 5), traced(true, 1), traced(false, 5)}) {
        const TracedFrame frame(b.scene, t);
        const Image image = focus_picture(frame.file(), f).image;
        FocusFrame of(frame.file());
        const PredictedError e = predict_error(of, {.focus = f}, image, f.views);
        EXPECT_GT(is_db(image, truth), e.bound_db);
        EXPECT_LT(e.bound_db, e.predicted_db);
        // Fine records with hidden surfaces have the smallest share of unsure view samples.
        EXPECT_GT(e.unsure_share, least_unsure);
        if (least_unsure == 0) least_unsure = e.unsure_share;
    }
}

TEST(PredictError, OfACropIsOfItsPixels) {
    const SceneBuilder b = bar_and_patches();
    const TracedFrame frame(b.scene, traced(true, 5));
    FocusSettings f = with(FocusMethod::scatter);
    // The light field of these records, with the greatest number of views.
    const Image all = focus_picture(frame.file(), with(FocusMethod::lightfield, most_lens_views)).image;
    // One crop with the bar's edges, and one without.
    for (const Crop& crop : {Crop{0, 0, 24, 48}, Crop{40, 4, 20, 40}}) {
        f.crop = crop;
        const Image image = focus_picture(frame.file(), f).image;
        expect_near(expected_db(frame.file(), f, image), is_db(image, all, crop), std::to_string(crop.x));
    }
}

TEST(PredictError, WithTheShutterOpen) {
    const SceneBuilder b = bar_and_patches(0.2);
    TraceSettings t = traced(true, 5);
    t.for_shutter = TimeSpan{0, 1};
    const TracedFrame frame(b.scene, t);
    const FrameMotion motion = motion_of(frame.file().header(), {});
    HybridSettings s{
        .focus = with(FocusMethod::lightfield, 64), .motion = &motion, .shutter = TimeSpan{0, 1}};
    FocusFrame of(frame.file(), true);
    const Image both = hybrid_picture(of, s).focus.image;
    expect_near(predict_error(of, s, both, 64).predicted_db, is_db(both, rays(b.scene, s.focus, s.shutter)),
                "");
    // The image of a pinhole.
    s.focus.lens.f_number = std::numeric_limits<double>::infinity();
    const MotionBlurResult blurred = frame.blur(MotionMethod::convolve);
    expect_near(predict_error(of, s, blurred.image, 0).predicted_db,
                is_db(blurred.image, rays(b.scene, s.focus, s.shutter)), "");
}

TEST(PredictError, SameBitsForAnyNumberOfThreads) {
    const SceneBuilder b = bar_and_patches();
    const TracedFrame frame(b.scene, traced(true, 2));
    const FocusSettings f = with(FocusMethod::layers);
    const Image image = focus_picture(frame.file(), f).image;
    const double whole = expected_db(frame.file(), f, image);
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(expected_db(frame.file(), f, image), whole) << threads;
    }
}

TEST(PredictError, RefusesWhatItCannotTell) {
    const SceneBuilder b = bar_and_patches();
    const TracedFrame frame(b.scene, traced(false, 0));
    const SampleHeader& h = frame.file().header();
    FocusSettings f = with(FocusMethod::scatter);
    f.impulse.kind = ImpulseKind::diffraction;
    EXPECT_THROW(check_predictable(h, f), Error);
    f = with(FocusMethod::scatter);
    f.framing = Framing::lens;
    EXPECT_THROW(check_predictable(h, f), Error);
    f = with(FocusMethod::scatter);
    f.crop = Crop{60, 0, 5, 5};
    EXPECT_THROW(check_predictable(h, f), Error);
    SampleHeader orthographic = h;
    orthographic.projection = Projection::orthographic;
    EXPECT_THROW(check_predictable(orthographic, with(FocusMethod::scatter)), Error);
    EXPECT_NO_THROW(check_predictable(h, with(FocusMethod::scatter)));
}

// A near, defocused mirror. Near its outline the lens sees reflected surfaces that the pinhole does not see,
// and all views get the surface that the pinhole sees next to them.
TEST(PredictError, BoundsWhatNobodySawInAMirrorsRim) {
    SceneBuilder b;
    b.add(board(-4, 4, -4, 4, 4), glowing({0.4, 0.4, 0.4}));
    b.add(board(-0.12, 0.12, -0.09, 0.09, 0.7), mirror());
    std::mt19937 random(1);
    std::uniform_real_distribution<double> colour(0.1, 0.9);
    constexpr double patch_m = 0.2;
    for (double y = -2; y < 2; y += patch_m) {
        for (double x = -2; x < 2; x += patch_m)
            b.add(board(x, x + patch_m, y, y + patch_m, -2),
                  glowing({colour(random), colour(random), colour(random)}));
    }
    const TracedFrame frame(b.scene, traced(true, 5));
    FocusSettings f = with(FocusMethod::lightfield, 256);
    f.focus_distance_m = 4;
    const Image image = focus_picture(frame.file(), f).image;
    FocusFrame of(frame.file());
    const PredictedError e = predict_error(of, {.focus = f}, image, f.views);
    const double is = is_db(image, rays(b.scene, f));
    EXPECT_GT(e.predicted_db, is + factor_of_two_db);
    EXPECT_GT(is, e.bound_db);
}

}  // namespace
}  // namespace postlens::test::predicted_error_test
