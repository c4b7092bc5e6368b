// Finding the lens of an image: known lenses are found again, and ambiguous images are rejected.
#include "compare/lens_from_picture.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "compare/lens_search/recorded_depths.h"
#include "core/error.h"
#include "focus/focus.h"
#include "pictures/aperture_file.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::lens_from_picture_test {
namespace {

constexpr int width = 128, height = 96;
/// Tangents of half the horizontal and vertical field of view, for F = 50 mm and a film width of 36 mm.
constexpr double tangent_x = 18.0 / 50, tangent_y = tangent_x * height / width;

/// Adds a texture of uniform random values with `cells` texels a side, interpolated, so that samples at pixel
/// corners represent it well.
void add_texture(Scene& scene, unsigned seed, int cells, glm::dvec2 repeat) {
    ImageTexture image{.width = cells, .height = cells, .repeat = repeat};
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> even(0.05F, 1);
    for (int k = 0; k < 3 * cells * cells; ++k) image.rgb.push_back(even(random));
    scene.materials.back().emission_texture = std::make_shared<Texture>(image);
}

void add_panel(SceneBuilder& b, const Rectangle& where, unsigned seed, glm::dvec2 repeat) {
    b.add(where, glowing({1, 1, 1}));
    add_texture(b.scene, seed, 16, repeat);
}

/// A wall across the view, from 1.5 m on the left to 9 m on the right, with 1/z linear over the image.
/// Optional panels in front of it have edges that hide surfaces which a lens would see.
Scene room(bool panels) {
    SceneBuilder b;
    b.scene.cameras[0].width = width;
    b.scene.cameras[0].height = height;
    const double near_m = 1.5, far_m = 9;
    const glm::dvec3 left{-tangent_x * near_m, 0, -near_m}, right{tangent_x * far_m, 0, -far_m};
    const glm::dvec3 along = right - left, up{0, 2.6 * tangent_y * far_m, 0};
    // The wall extends beyond the view on both sides.
    const glm::dvec3 start = left - 0.05 * along - 0.5 * up;
    add_panel(b, Rectangle{start, along * 1.3, up}, 1, {9, 9});
    if (panels) {
        add_panel(b, Rectangle{{-0.1, -0.45, -1.3}, {0.22, 0, 0}, {0, 0.5, 0}}, 2, {1, 2});
        add_panel(b, Rectangle{{0.35, 0.1, -2.2}, {0.4, 0, 0}, {0, 0.8, 0}}, 3, {1, 2});
    }
    return b.scene;
}

struct Traced {
    TemporaryFolder folder;
    Scene scene;
    std::unique_ptr<SampleFileReader> file;

    /// With one level, records are coarse, but as right for images that are made from them.
    explicit Traced(Scene of, const std::optional<int>& levels = {}) : scene(std::move(of)) {
        TraceSettings settings;
        settings.overscan_px = 8;
        if (levels) settings.subdivision.levels = *levels;
        trace_to_file(scene, settings, folder.path() / "frame.exr");
        file = std::make_unique<SampleFileReader>(folder.path() / "frame.exr");
    }
};

Image rendered(const Scene& scene, double f_number, double focus_m, int spp = 256) {
    RenderSettings s;
    s.focal_length_mm = 50;
    s.f_number = f_number;
    s.focus_m = focus_m;
    s.spp = spp;
    return render_picture(scene, s).image;
}

Image focused(const SampleFileReader& file, double f_number, double focus_m) {
    return focus_picture(file, {.lens = {50, f_number}, .focus_distance_m = focus_m, .depths = 256}).image;
}

void expect_lens(const LensFromPicture& found, double f_number, double focus_m, double tolerance) {
    EXPECT_NEAR(found.best.place.aperture_mm * f_number / 50, 1, tolerance);
    EXPECT_NEAR(found.best.place.inverse_focus_per_m * focus_m, 1, tolerance);
}

/// The error message for an image; fails if a lens is found.
std::string refusal(const SampleFileReader& file, const Image& picture, ExitCode code,
                    const LensFromPictureSettings& settings = {}) {
    try {
        const LensFromPicture found = lens_from_picture(file, picture, settings);
        ADD_FAILURE() << "found an aperture of " << found.best.place.aperture_mm << " mm";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        return e.what();
    }
    return "";
}

// An image by `focus` with the same depths leaves no error. The descent ends when the error decreases by less
// than 1e-4 of itself; before that it converges quadratically to 0, from 3 % or less.
TEST(LensFromPicture, FindsTheLensOfAPictureByFocus) {
    const Traced room_with_panels(room(true), 1);
    const LensFromPicture found =
        lens_from_picture(*room_with_panels.file, focused(*room_with_panels.file, 0.6, 3));
    expect_lens(found, 0.6, 3, 1e-3);
    EXPECT_LT(found.best.error, 1e-3);
    EXPECT_TRUE(found.others.empty());
}

// The specified accuracy is 1 % for 256 samples per pixel and CoCs of 5 to 10 px. Noise makes a standard
// error of at most 0.1 %; the rest is the error of `focus` (docs/lens.md).
TEST(LensFromPicture, FindsALensFocusedNear) {
    const Traced t(room(true));
    const LensFromPicture found = lens_from_picture(*t.file, rendered(t.scene, 0.6, 2));
    expect_lens(found, 0.6, 2, 0.01);
    EXPECT_GT(found.largest_coc_px, 5);
    EXPECT_LT(found.aperture_error_mm, 0.01 * found.best.place.aperture_mm);
    EXPECT_GT(found.aperture_error_mm, 0);
    EXPECT_GT(found.inverse_focus_error_per_m, 0);
    EXPECT_LT(found.pictures, 100);
}

TEST(LensFromPicture, FindsALensFocusedFar) {
    const Traced t(room(true));
    expect_lens(lens_from_picture(*t.file, rendered(t.scene, 0.6, 5)), 0.6, 5, 0.01);
}

// The near end of the wall has the same blur for a focus before and behind it. The coarse search finds minima
// on both sides, and must choose the right one.
TEST(LensFromPicture, TellsNearFromFarFocus) {
    const Traced t(room(false));
    const Image picture = rendered(t.scene, 1, 2);
    const std::vector<RoughMatch> starts =
        blur_search(pinhole_picture(*t.file), picture, recorded_depths(*t.file), t.file->header());
    EXPECT_GT(starts.size(), 1U);
    expect_lens(lens_from_picture(*t.file, picture), 1, 2, 0.01);
}

TEST(LensFromPicture, RefusesWhatTellsNoLens) {
    const Traced t(room(false), 1);
    Image even(width, height);
    for (float& v : even.rgb) v = 0.4F;
    EXPECT_NE(refusal(*t.file, even, ExitCode::invalid_input).find("same all over"), std::string::npos);
    EXPECT_NE(refusal(*t.file, pinhole_picture(*t.file), ExitCode::invalid_input).find("no blur"),
              std::string::npos);
    // A render without a lens, which differs by its noise and pixel filter, is also rejected.
    EXPECT_NE(refusal(*t.file, rendered(t.scene, std::numeric_limits<double>::infinity(), 2, 64),
                      ExitCode::invalid_input)
                  .find("no blur"),
              std::string::npos);
}

TEST(LensFromPicture, RefusesAPictureOfSomethingElse) {
    const Traced t(room(false), 1);
    Image noise(width, height);
    std::mt19937 random(1);
    for (float& v : noise.rgb) v = std::uniform_real_distribution<float>(0, 1)(random);
    EXPECT_NE(refusal(*t.file, noise, ExitCode::invalid_input).find("no lens makes"), std::string::npos);
    // The mirror image of the room has the same colours and depths at other positions.
    const Image picture = focused(*t.file, 1, 2);
    Image mirrored(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) std::copy_n(picture.pixel(width - 1 - x, y), 3, mirrored.pixel(x, y));
    }
    EXPECT_NE(refusal(*t.file, mirrored, ExitCode::invalid_input).find("no lens makes"), std::string::npos);
}

// With a single depth, a small aperture with a focus far from it and a large one with a focus near it are
// equal.
TEST(LensFromPicture, RefusesOneDepth) {
    SceneBuilder b;
    b.scene.cameras[0].width = width;
    b.scene.cameras[0].height = height;
    add_panel(b, square({0, 0, -3}, {0, 0, 1}, 4), 1, {3, 3});
    const Traced t(b.scene, 1);
    EXPECT_NE(refusal(*t.file, focused(*t.file, 0.6, 1.5), ExitCode::invalid_input).find("apart"),
              std::string::npos);
}

TEST(LensFromPicture, RefusesWhatIsNoPictureOfTheView) {
    const Traced t(room(false), 1);
    EXPECT_NE(refusal(*t.file, Image(64, 48), ExitCode::invalid_input).find("64x48"), std::string::npos);
    Image bad(width, height);
    bad.rgb[5] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(refusal(*t.file, bad, ExitCode::invalid_input).find("not finite"), std::string::npos);
    (void)refusal(*t.file, Image(width, height), ExitCode::wrong_arguments, {.starts = 0});
}

// Pixels are unreliable exactly within the CoC of a depth edge.
TEST(ReliablePixels, LeaveOutWhatADepthEdgeReaches) {
    RecordedDepths d{.width = 41, .height = 31, .overscan_px = 100};
    d.nearest_per_m.assign(41 * 31, 0.5F);
    d.farthest_per_m.assign(41 * 31, 0.5F);
    d.nearest_per_m[15 * 41 + 20] = 1;
    // The CoC is 0 at 2 m and 10 px at 1 m.
    const FocusGeometry geometry{.aperture_radius_m = 0.01, .inverse_focus_per_m = 0.5, .gain_px = 1000};
    const std::vector<char> reliable = reliable_pixels(d, geometry);
    for (int y = 0; y < 31; ++y) {
        for (int x = 0; x < 41; ++x)
            EXPECT_EQ(reliable[static_cast<std::size_t>(y * 41 + x)] == 0, std::hypot(x - 20, y - 15) <= 6.5);
    }
}

}  // namespace
}  // namespace postlens::test::lens_from_picture_test
