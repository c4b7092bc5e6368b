// A crop is bit-identical to the same pixels of the whole image, although methods skip work outside of the
// crop.
#include "pictures/crop.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "focus/focus.h"
#include "focus/light_field/field_focus.h"
#include "focus/light_field/field_surfaces.h"
#include "motionblur/motion_blur.h"
#include "pictures/aperture_file.h"
#include "planner/auto_picture.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::crop_test {
namespace {

const std::string samples = POSTLENS_SAMPLES;

/// Size of the images: larger than two blocks of most methods (64 px), and not a multiple of a block.
constexpr int width = 140, height = 136;
/// Crops within a block, over several blocks up to the lower right corner, and of a single pixel.
constexpr Crop inside{70, 68, 41, 23}, far_corner{90, 46, 50, 90}, one_pixel{13, 135, 1, 1};

/// The same for the method scatter, whose blocks are of 256 px.
constexpr int scatter_width = 264, scatter_height = 260;
constexpr Crop scatter_inside{70, 90, 41, 23}, scatter_corner{214, 170, 50, 90}, scatter_pixel{13, 259, 1, 1};

class CropTest : public testing::Test {
  protected:
    const SampleFileReader& traced(const std::string& name, TraceSettings settings = {}) {
        scene_ = read_scene(samples + "/scenes/" + name);
        if (!settings.camera.width) settings.camera.width = width;
        if (!settings.camera.height) settings.camera.height = height;
        settings.subdivision.levels = 1;
        const auto path = folder_.path() / "frame.exr";
        trace_to_file(*scene_, settings, path);
        file_.emplace(path);
        return *file_;
    }
    static void expect_same(const Image& part, const Image& whole, const Crop& crop) {
        EXPECT_TRUE(cut(part, crop).rgb == cut(whole, crop).rgb)
            << crop.x << "," << crop.y << "," << crop.width << "," << crop.height;
    }
    void expect_bits_of_the_whole(FocusSettings settings, const std::vector<Crop>& crops) {
        const Image whole = focus_picture(*file_, settings).image;
        for (const Crop& crop : crops) {
            settings.crop = crop;
            expect_same(focus_picture(*file_, settings).image, whole, crop);
        }
    }
    void expect_bits_of_the_whole(HybridSettings settings, const std::vector<Crop>& crops) {
        const Image whole = hybrid_picture(*file_, settings).focus.image;
        for (const Crop& crop : crops) {
            settings.focus.crop = crop;
            expect_same(hybrid_picture(*file_, settings).focus.image, whole, crop);
        }
    }
    void expect_bits_of_the_whole(MotionBlurSettings settings, const std::vector<Crop>& crops) {
        const Image whole = motion_blur(*file_, settings).image;
        for (const Crop& crop : crops) {
            settings.crop = crop;
            expect_same(motion_blur(*file_, settings).image, whole, crop);
        }
    }

    TemporaryFolder folder_;
    std::optional<Scene> scene_;
    std::optional<SampleFileReader> file_;
};

const FocusSettings wide{.lens = {.focal_length_mm = 50, .f_number = 2.8}, .focus_distance_m = 1};

TEST_F(CropTest, PinholeAndScatter) {
    TraceSettings trace{.overscan_px = 8};
    trace.camera.width = scatter_width;
    trace.camera.height = scatter_height;
    traced("bars.toml", trace);
    FocusSettings s = wide;
    s.method = FocusMethod::pinhole;
    expect_bits_of_the_whole(s, {scatter_inside, scatter_corner, scatter_pixel});
    expect_same(pinhole_picture(*file_, scatter_inside), pinhole_picture(*file_), scatter_inside);
    s.method = FocusMethod::scatter;
    expect_bits_of_the_whole(s, {scatter_inside, scatter_corner, scatter_pixel});
    s.depths = 9;
    expect_bits_of_the_whole(s, {scatter_corner});
    // The film distance of this framing changes the magnification.
    s.framing = Framing::breathing;
    expect_bits_of_the_whole(s, {scatter_inside});
    s = wide;
    s.impulse = {.kind = ImpulseKind::polygon, .blades = 6, .cats_eye = 0.6};
    expect_bits_of_the_whole(s, {scatter_corner});
}

class InStrips : public CropTest, public testing::WithParamInterface<FocusMethod> {};

TEST_P(InStrips, HasTheBitsOfTheWhole) {
    TraceSettings trace{.overscan_px = 8, .hidden_layers = 1};
    std::vector<Crop> crops{far_corner, one_pixel};
    std::size_t splat_bytes = 3 << 18;
    if (GetParam() == FocusMethod::scatter) {
        trace.camera.width = scatter_width;
        trace.camera.height = scatter_height;
        crops = {scatter_corner, scatter_pixel};
        splat_bytes = 3 << 20;
    }
    traced(GetParam() == FocusMethod::scatter ? "bars.toml" : "still_life.toml", trace);
    for (const Impulse& impulse :
         {Impulse{}, Impulse{.kind = ImpulseKind::polygon, .blades = 6, .cats_eye = 0.6}}) {
        FocusSettings s = wide;
        s.method = GetParam();
        if (s.method == FocusMethod::layers && impulse.kind == ImpulseKind::disc) continue;  // slow
        s.lens.f_number = 16;
        s.impulse = impulse;
        const FocusResult whole = focus_picture(*file_, s);
        s.splat_bytes = splat_bytes;  // makes several strips, some of them in several parts
        const FocusResult strips = focus_picture(*file_, s);
        EXPECT_TRUE(strips.image.rgb == whole.image.rgb);
        EXPECT_EQ(strips.depths, whole.depths);
        EXPECT_EQ(strips.largest_coc_px, whole.largest_coc_px);
        EXPECT_EQ(strips.warnings.size(), whole.warnings.size());
        for (const Crop& crop : crops) {
            s.crop = crop;
            expect_same(focus_picture(*file_, s).image, whole.image, crop);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CropTest, InStrips, testing::Values(FocusMethod::scatter, FocusMethod::layers));

TEST_F(CropTest, Layers) {
    traced("still_life.toml", {.overscan_px = 8, .hidden_layers = 1});
    FocusSettings s = wide;
    s.method = FocusMethod::layers;
    expect_bits_of_the_whole(s, {inside, far_corner});
}

TEST_F(CropTest, LightFieldInStripsHasTheBitsOfTheWhole) {
    // One scene has mirrors, glass and lights. In the other, so much is in focus that views of single
    // surfaces are left out.
    for (const bool leave_out : {false, true}) {
        if (leave_out) {
            traced("motion.toml");
        } else {
            traced("still_life.toml", {.overscan_px = 8, .hidden_layers = 1});
        }
        const SampleHeader& h = file_->header();
        FieldFocusSettings s{focus_geometry({50, leave_out ? 16 : 2.8}, leave_out ? 3 : 1, Framing::keep,
                                            {h.film_distance_mm, h.pixel_pitch_mm}),
                             read_aperture({.kind = ImpulseKind::polygon, .blades = 6}),
                             {0, width, 0, height},
                             8,
                             {},
                             {},
                             {}};
        if (leave_out) s.leave_out_from_share = 0.05;
        std::uint64_t told = 0;
        s.also.rows = [&](const RecordBand& band, int y_begin, int y_end) {
            told +=
                band.offsets[band.pixel(band.x_begin, y_end - 1) + static_cast<std::size_t>(band.width())] -
                band.offsets[band.pixel(band.x_begin, y_begin)];
        };
        FocusFrame frame(*file_);
        const FieldFocus whole = field_focus(frame, s);
        EXPECT_EQ(told, file_->record_count());
        s.surface_bytes = 1;  // makes one strip per row of tiles
        told = 0;
        const FieldFocus strips = field_focus(frame, s);
        EXPECT_EQ(told, file_->record_count());
        EXPECT_TRUE(strips.image.rgb == whole.image.rgb);
        EXPECT_TRUE(strips.unknown == whole.unknown);
        EXPECT_TRUE(strips.unknown_below == whole.unknown_below);
        EXPECT_TRUE(strips.left_out == whole.left_out);
        EXPECT_EQ(std::find(whole.left_out.begin(), whole.left_out.end(), 1) != whole.left_out.end(),
                  leave_out);
        s.crop = far_corner;
        expect_same(field_focus(frame, s).image, whole.image, far_corner);
    }
}

TEST_F(CropTest, AFewRowsOfSquaresTellWhatAllSurfacesTake) {
    for (const char* scene : {"still_life.toml", "bars.toml"}) {
        TraceSettings trace{.overscan_px = 8};
        trace.camera.width = 264;
        trace.camera.height = 260;
        traced(scene, trace);
        const TreeSheets all = tree_sheets(*file_, 0, {});
        const PatchLens lens{50, 0.3};
        const auto bytes = [](const auto&... lists) {
            return static_cast<double>(((lists.size() * sizeof(lists[0])) + ...));
        };
        double is = 0;
        for (const SheetMesh* m : {&all.primary, &all.deeper}) {
            const PatchMesh p = cut_patches(*m, lens);
            is += bytes(m->sheets, m->fine, m->coarse, m->planes, m->bends, m->nodes, m->texels, m->below,
                        m->bright, m->bright_texels, p.patches, p.planes, p.follows);
        }
        const double told =
            surface_bytes_of_record(*file_, lens, {}) * static_cast<double>(file_->record_count());
        // Six of the seventeen rows of squares.
        EXPECT_NEAR(told / is, 1, 0.35) << scene;
        EXPECT_LT(told / static_cast<double>(file_->record_count()), most_surface_bytes_of_record);
    }
}

TEST_F(CropTest, LightFieldOverLensAndShutterInStripsHasTheBitsOfTheWhole) {
    // A file of two instants, and a file of one instant with lights that move from strip to strip.
    for (const int keys : {2, 1}) {
        const char* scene = keys == 1 ? "motion/streaking_lights.toml" : "motion.toml";
        traced(scene, {.overscan_px = 8, .for_shutter = TimeSpan{0, 1}, .keys = keys});
        const SampleHeader& h = file_->header();
        const FrameMotion motion(h);
        FieldFocusSettings s{
            focus_geometry({50, 2.8}, 3, Framing::keep, {h.film_distance_mm, h.pixel_pitch_mm}),
            read_aperture({}),
            {0, width, 0, height},
            8,
            {},
            {},
            {}};
        s.shutter = FieldShutter{.motion = &motion, .open_s = 0, .close_s = 1};
        FocusFrame frame(*file_);
        const FieldFocus whole = field_focus(frame, s);
        EXPECT_EQ(whole.light_square.empty(), keys != 1);
        s.surface_bytes = 1;
        const FieldFocus strips = field_focus(frame, s);
        EXPECT_TRUE(strips.image.rgb == whole.image.rgb) << scene;
        EXPECT_TRUE(strips.unknown == whole.unknown) << scene;
    }
}

TEST_F(CropTest, LightFieldHybridAndAuto) {
    traced("still_life.toml", {.overscan_px = 8});
    FocusSettings s = wide;
    s.method = FocusMethod::lightfield;
    s.views = 12;
    expect_bits_of_the_whole(s, {inside, far_corner, one_pixel});
    expect_bits_of_the_whole(HybridSettings{.focus = s}, {inside, far_corner});
    // With rays.
    expect_bits_of_the_whole(HybridSettings{.focus = s, .scene = &*scene_}, {far_corner});
    // A crop is planned as a part of the whole image.
    AutoSettings planned{.hybrid = {.focus = wide}, .target_db = 22};
    FocusFrame frame(*file_);
    const Image whole = auto_picture(frame, planned).hybrid.focus.image;
    planned.hybrid.focus.crop = inside;
    expect_same(auto_picture(frame, planned).hybrid.focus.image, whole, inside);
}

TEST_F(CropTest, HybridThatScatters) {
    // With this number of views, scattering is faster where a single surface is seen.
    TraceSettings trace;
    trace.camera.width = scatter_width;
    trace.camera.height = scatter_height;
    traced("motion.toml", trace);
    HybridSettings s{.focus = wide};
    s.focus.lens.f_number = 16;
    s.focus.focus_distance_m = 3;
    s.focus.views = 400;
    EXPECT_GT(hybrid_picture(*file_, s).scattered_share, 0.1);
    expect_bits_of_the_whole(s, {inside, far_corner});
}

TEST_F(CropTest, MotionByEveryMethod) {
    traced("motion.toml", {.for_shutter = TimeSpan{0, 1}, .keys = 2});
    for (const MotionMethod method :
         {MotionMethod::convolve, MotionMethod::lightfield, MotionMethod::automatic}) {
        expect_bits_of_the_whole(MotionBlurSettings{.exposure = {0.2, 0.7}, .method = method, .views = 32},
                                 {inside, far_corner});
    }
}

TEST_F(CropTest, LensAndShutterWithGapsFilledFromAfar) {
    // No hidden surfaces are recorded, so moving objects leave holes in all views.
    traced("motion.toml");
    const FrameMotion motion = motion_of(file_->header(), {});
    FocusSettings s = wide;
    s.lens.f_number = 22;
    s.focus_distance_m = 3;
    s.views = 8;
    const HybridSettings both{.focus = s, .motion = &motion, .shutter = TimeSpan{0.9, 1}};
    const Image whole = hybrid_picture(*file_, both).focus.image;
    // Crops spread over the image: some contain holes, some do not.
    for (int y = 10; y + 20 <= height; y += 45) {
        for (int x = 10; x + 30 <= width; x += 45) {
            HybridSettings part = both;
            part.focus.crop = Crop{x, y, 30, 20};
            expect_same(hybrid_picture(*file_, part).focus.image, whole, *part.focus.crop);
        }
    }
    expect_bits_of_the_whole(
        MotionBlurSettings{.exposure = {0.9, 1}, .method = MotionMethod::lightfield, .views = 16},
        {inside, far_corner});
}

TEST_F(CropTest, SharesAreThoseOfTheCrop) {
    traced("still_life.toml");
    FocusSettings s = wide;
    const auto share = [&](const std::optional<Crop>& crop) {
        s.crop = crop;
        for (const FocusWarning& w : focus_picture(*file_, s).warnings) {
            if (w.code == "overscan") return w.share;
        }
        return 0.0;
    };
    const double all = share(std::nullopt);
    EXPECT_GT(all, 0);
    EXPECT_LT(all, 1);
    EXPECT_EQ(share(Crop{0, 0, width, height}), all);
    EXPECT_EQ(share(Crop{0, 53, 1, 20}), 1);    // along the border
    EXPECT_EQ(share(Crop{65, 63, 10, 10}), 0);  // in the middle
}

TEST_F(CropTest, RenderTracesOnlyTheTilesOfTheCrop) {
    const Scene scene = read_scene(samples + "/scenes/motion.toml");
    RenderSettings s;
    s.camera.width = 60;
    s.camera.height = 50;
    s.spp = 4;
    s.halves = true;
    s.shutter = TimeSpan{0, 1};
    const RenderResult whole = render_picture(scene, s);
    s.crop = Crop{21, 9, 13, 20};
    const RenderResult part = render_picture(scene, s);
    expect_same(part.image, whole.image, *s.crop);
    for (const std::size_t h : {0U, 1U}) expect_same(part.halves[h], whole.halves[h], *s.crop);
    EXPECT_EQ(part.rays.eye, 24U * 24U * 4U);  // tiles of 8 px: columns 2 to 4, rows 1 to 3
}

TEST_F(CropTest, RenderWritesTheCrop) {
    const Scene scene = read_scene(samples + "/scenes/motion.toml");
    RenderSettings s;
    s.camera.width = 40;
    s.camera.height = 30;
    s.spp = 4;
    const Image whole = render_picture(scene, s).image;
    s.crop = Crop{5, 5, 20, 9};
    const auto path = folder_.path() / "part.exr";
    render_to_file(scene, s, path);
    EXPECT_TRUE(read_image(path).rgb == cut(whole, s.crop).rgb);
}

TEST(Crop, MustLieWithinThePicture) {
    EXPECT_NO_THROW(check_crop(std::nullopt, 4, 3));
    EXPECT_NO_THROW(check_crop(Crop{0, 0, 4, 3}, 4, 3));
    EXPECT_NO_THROW(check_crop(Crop{3, 2, 1, 1}, 4, 3));
    constexpr int most = std::numeric_limits<int>::max();
    for (const Crop& bad :
         {Crop{0, 0, 5, 3}, Crop{0, 0, 4, 4}, Crop{1, 0, 4, 1}, Crop{4, 0, 1, 1}, Crop{0, 0, 0, 1},
          Crop{0, 0, 1, -1}, Crop{-1, 0, 2, 1}, Crop{3, 0, most, 1}, Crop{most, 0, most, 1}}) {
        EXPECT_THROW(check_crop(bad, 4, 3), Error);
        EXPECT_THROW((void)cut(Image(4, 3), bad), Error);
    }
}

}  // namespace
}  // namespace postlens::test::crop_test
