// All kinds of apertures: the focused image against rays through the same aperture. The scene is one plane,
// so nothing is hidden and only the blur is tested.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "core/error.h"
#include "core/threads.h"
#include "focus/focus.h"
#include "focus/responses/response_model.h"
#include "pictures/aperture_file.h"
#include "pictures/image.h"
#include "tests/focus/focus_records.h"
#include "tests/focus/layer_records.h"
#include "tests/focus/mosaic.h"
#include "tests/planner/bar_scene.h"
#include "tests/support/motion_frame.h"
#include "tests/support/random_records.h"
#include "tests/support/reference.h"
#include "tests/support/temporary_folder.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::impulse_focus_test {
namespace {

constexpr double depth_m = 4;
constexpr double gain_px = 50.0 / 36 * 64;
/// The radius of the CoC is 6.7 px with the focus at 1.6 m, -3.3 px at 16 m and -4.4 px at infinity.
constexpr ThinLens lens{.focal_length_mm = 200, .f_number = 0.5};

class ImpulseFocus : public testing::Test {
  protected:
    // Traces the scene once, in the first test, because a temporary folder needs the name of a test.
    void SetUp() override {
        if (scene_ != nullptr) return;
        scene_ = new Scene(mosaic(depth_m, 0.33));
        folder_ = new TemporaryFolder();
        TraceSettings settings;
        settings.overscan_px = 12;
        // Tiles of the mosaic meet at pixel corners. A corner sees the first tile, which displaces the border
        // by half a cell.
        settings.subdivision.levels = 5;
        trace_to_file(*scene_, settings, folder_->path() / "frame.exr");
        file_ = new SampleFileReader(folder_->path() / "frame.exr");
        frame_ = new FocusFrame(*file_, true);
        std::ofstream letter(folder_->path() / "F.pgm");
        letter << "P2 5 7 255 255 255 255 255 255 255 0 0 0 0 255 255 255 255 0 255 0 0 0 0 255 0 0 0 0 "
                  "255 0 0 0 0 255 0 0 0 0";
    }
    static void TearDownTestSuite() {
        delete frame_;
        delete file_;
        delete folder_;
        delete scene_;
    }
    static Image focused(const Impulse& impulse, double focus_m) {
        return focus_picture(*frame_, {.lens = lens, .focus_distance_m = focus_m, .impulse = impulse}).image;
    }
    static Reference rays(const Impulse& impulse, double focus_m) {
        RenderSettings s;
        s.focal_length_mm = lens.focal_length_mm;
        s.f_number = lens.f_number;
        s.focus_m = focus_m;
        s.spp = impulse.cats_eye > 0 ? 1024 : 128;
        s.aperture = std::make_shared<Aperture>(read_aperture(impulse));
        if (impulse.cats_eye == 0) return reference(*scene_, s);
        const Image image = render_picture(*scene_, s).image;
        return {image, {image, image}};
    }
    static Impulse letter() { return {.kind = ImpulseKind::picture, .file = folder_->path() / "F.pgm"}; }

    static inline Scene* scene_ = nullptr;
    static inline TemporaryFolder* folder_ = nullptr;
    static inline SampleFileReader* file_ = nullptr;
    static inline FocusFrame* frame_ = nullptr;
};

// The noise of the rays is subtracted. Apertures that lose light at the border of the field need more rays,
// because their mean is wrong by up to 1.9e-3 of a tolerance of 2e-3; the noise of these is negligible.
TEST_F(ImpulseFocus, AgreesWithRaysThroughTheSameAperture) {
    const std::vector<Impulse> impulses{
        {},
        {.kind = ImpulseKind::polygon, .blades = 3, .rotation_deg = 20},
        {.kind = ImpulseKind::polygon, .blades = 5, .rotation_deg = -90, .roundness = 0.4, .squeeze = 1.7},
        {.squeeze = 2},
        letter(),
        {.cats_eye = 0.9},
        {.kind = ImpulseKind::polygon, .blades = 6, .cats_eye = 0.5},
        {.spherical = 0.12},
        {.kind = ImpulseKind::polygon, .blades = 3, .spherical = -0.2}};
    for (const double focus_m : {1.6, 30.0}) {
        for (const Impulse& impulse : impulses) {
            // A disc or an ellipse of a thin lens is the same before and behind the focus.
            if (focus_m > depth_m && impulse.kind == ImpulseKind::disc && impulse.cats_eye == 0 &&
                impulse.spherical == 0)
                continue;
            const Image got = focused(impulse, focus_m);
            const Reference truth = rays(impulse, focus_m);
            const std::string what =
                fmt::format("{}, squeeze {}, cat's eye {}, spherical {}, focus {} m", impulse_text(impulse),
                            impulse.squeeze, impulse.cats_eye, impulse.spherical, focus_m);
            EXPECT_GT(psnr(got, truth, 12), 46) << what;
            // Both images lose the same amount of light.
            EXPECT_NEAR(mean(got) / mean(truth.image), 1, 2e-3) << what;
        }
    }
}

TEST_F(ImpulseFocus, LayersLoseAsMuchLight) {
    for (const double focus_m : {1.6, 30.0}) {
        const Impulse impulse{.cats_eye = 0.9};
        const Reference truth = rays(impulse, focus_m);
        const Image got = focus_picture(*frame_, {.lens = lens,
                                                  .focus_distance_m = focus_m,
                                                  .method = FocusMethod::layers,
                                                  .impulse = impulse})
                              .image;
        EXPECT_GT(psnr(got, truth, 12), 46) << focus_m;
        EXPECT_NEAR(mean(got) / mean(truth.image), 1, 4e-3)
            << focus_m;  // 2.5e-3 measured, 1.9e-3 of it noise
    }
}

// The lens points through which light of a surface passes decide what hides it. With spherical aberration
// they are no longer proportional to the position in the image of a point.
TEST(SphericalAberration, HidesWhatRaysDoNotSee) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(true));
    for (const double spherical : {-1.5, 1.5}) {
        const Impulse impulse{.spherical = spherical};
        RenderSettings by = by_rays(settings(3), 128);
        by.aperture = std::make_shared<Aperture>(read_aperture(impulse));
        const Reference truth = reference(b.scene, by);
        const Image got =
            focus_picture(
                frame.file(),
                {.lens = wide, .focus_distance_m = 3, .method = FocusMethod::layers, .impulse = impulse})
                .image;
        // 32.5 and 40.0 dB measured. For lens points of a perfect lens, -1.5 has 26.2 dB.
        EXPECT_GT(psnr(got, truth), 31.5) << spherical;
    }
}

// Some responses have a wide halo around a sharp core. Where pixels are subdivided, the core must stay at the
// position of its sample, however far the halo reaches.
class WideHalo : public testing::Test {
  protected:
    void SetUp() override {
        std::mt19937 random(5);
        band_ = random_band(random, -overscan, width + overscan + 1, -overscan, height + overscan + 1,
                            {.levels = 3, .probability = 0.4});
        for (Record& r : band_.records) {
            r.id = 1;
            r.z = 0.5F;
        }
        geometry_.gain_px *= 4;
        geometry_.inverse_focus_per_m = 2;
    }
    /// Largest difference between `layers` and `scatter`.
    double difference_of_methods(const Impulse& impulse) {
        const std::shared_ptr<const ResponseModel> response =
            response_model(impulse, geometry_, std::hypot(width, height) / 2);
        Image by_scatter, by_layers;
        scatter(*tables_of(band_, overscan, {.geometry = geometry_}, response), by_scatter);
        layers(*splats_of(band_, overscan, {.geometry = geometry_}, response), by_layers);
        return difference(by_layers, by_scatter);
    }

    static constexpr int overscan = 20, width = 40, height = 30;
    RecordBand band_;
    FocusGeometry geometry_ = unit_geometry;
};

TEST_F(WideHalo, OfAStrongAberrationKeepsItsCore) {
    EXPECT_LT(difference_of_methods({.spherical = 4}), 1e-4);
}

TEST_F(WideHalo, OfAPinholeInAGreyFilterKeepsItsCore) {
    const TemporaryFolder folder;
    std::ofstream picture(folder.path() / "pinhole.pgm");
    constexpr int side = 31;
    picture << "P2 " << side << " " << side << " 255\n";
    for (int i = 0; i < side * side; ++i) picture << (i == side * side / 2 ? "255 " : "1 ");
    picture.close();
    geometry_.inverse_focus_per_m = 6;
    EXPECT_LT(difference_of_methods({.kind = ImpulseKind::picture, .file = folder.path() / "pinhole.pgm"}),
              1e-4);
}

// In focus, 1 % of the light lies beyond 8 times the Airy disc's diameter.
TEST_F(WideHalo, OfDiffractionKeepsItsCore) {
    // An Airy disc of 2 px: 2.44 lambda gain / (2 radius).
    geometry_.aperture_radius_m = 2.44 * 550e-9 * geometry_.gain_px / 4;
    EXPECT_LT(difference_of_methods({.kind = ImpulseKind::diffraction, .wavelengths_nm = {550}}), 2e-3);
}

// Each pixel of a uniform wall is darkened by the share of the lens through which it sees, without seams
// where one kernel follows another.
TEST(VignettedWall, IsDarkenedByWhatEachPixelSees) {
    constexpr int width = 64, height = 40, overscan = 12;
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 0.5;
    for (const Impulse& impulse :
         {Impulse{.cats_eye = 1}, Impulse{.kind = ImpulseKind::polygon, .cats_eye = 0.6},
          Impulse{.squeeze = 2, .cats_eye = 1.2}}) {
        for (const double radius_px : {0.6, 4.0}) {
            geometry.gain_px *= radius_px / std::abs(geometry.coc_diameter_px(0.25) / 2);
            const std::shared_ptr<const ResponseModel> response =
                response_model(impulse, geometry, std::hypot(width, height) / 2);
            const RecordBand band = corner_band(width, height, overscan, [](int, int) {
                return std::vector<Record>{corner(4, 0.5F, 0.4F, 0.3F)};
            });
            Image by_scatter, by_layers;
            scatter(*tables_of(band, overscan, {.geometry = geometry}, response), by_scatter);
            layers(*splats_of(band, overscan, {.geometry = geometry}, response), by_layers);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const glm::dvec2 place(x + 0.5 - width / 2.0, y + 0.5 - height / 2.0);
                    const double open = response->transmission(place, geometry.inverse_focus_per_m);
                    for (const Image* image : {&by_scatter, &by_layers}) {
                        ASSERT_NEAR(static_cast<double>(image->pixel(x, y)[0]), 0.5 * open, 3e-4)
                            << impulse_text(impulse) << " " << radius_px << ": " << x << ", " << y;
                    }
                }
            }
        }
    }
}

// Shows that the test above can fail: an aperture upside down, or at another field position, has a larger
// error.
TEST_F(ImpulseFocus, TellsApertureFromAperture) {
    const Reference triangle = rays({.kind = ImpulseKind::polygon, .blades = 3, .rotation_deg = 20}, 1.6);
    EXPECT_LT(
        psnr(focused({.kind = ImpulseKind::polygon, .blades = 3, .rotation_deg = 200}, 1.6), triangle, 12),
        38);
    const Reference vignetted = rays({.cats_eye = 0.9}, 1.6);
    EXPECT_LT(psnr(focused({}, 1.6), vignetted, 12), 36);
    EXPECT_LT(psnr(focused({.spherical = -0.12}, 1.6), rays({.spherical = 0.12}, 1.6), 12), 36);
}

TEST_F(ImpulseFocus, InFocusAllAreThePinholeButForLostLight) {
    const Image pinhole = pinhole_picture(*file_);
    // A sample on a border with a response of 1e-4 px is divided among pixels by its rounded position.
    constexpr float tolerance = 1e-4F;
    for (const Impulse& impulse :
         {Impulse{.kind = ImpulseKind::polygon, .blades = 5}, letter(), Impulse{.squeeze = 3}}) {
        const Image got = focused(impulse, depth_m);
        for (std::size_t i = 0; i < got.rgb.size(); ++i)
            ASSERT_NEAR(got.rgb[i], pinhole.rgb[i], tolerance * std::max(1.0F, pinhole.rgb[i]))
                << impulse_text(impulse);
    }
    const Impulse cats_eye{.cats_eye = 0.8};
    const Image got = focused(cats_eye, depth_m);
    const Aperture aperture = read_aperture(cats_eye);
    for (int y = 0; y < got.height; ++y) {
        for (int x = 0; x < got.width; ++x) {
            // Within a pixel the loss changes by at most 0.8 / 40 * 2 / pi.
            const glm::dvec2 field((x + 0.5 - got.width / 2.0) / 40, (y + 0.5 - got.height / 2.0) / 40);
            const auto expected = static_cast<double>(pinhole.pixel(x, y)[1]) *
                                  aperture.transmission(field, 1 - 0.8 * 0.2 * gain_px / 40 / depth_m);
            ASSERT_NEAR(static_cast<double>(got.pixel(x, y)[1]), expected, 0.015 * std::max(0.1, expected))
                << x << ", " << y;
        }
    }
}

TEST_F(ImpulseFocus, SameBitsForAnyNumberOfThreads) {
    for (const Impulse& impulse : {letter(), Impulse{.cats_eye = 0.9}, Impulse{.spherical = 0.1}}) {
        Image first;
        for (const int threads : {1, 5}) {
            const ThreadLimit limit(threads);
            const Image image = focused(impulse, 1.6);
            if (threads == 1) first = image;
            EXPECT_TRUE(image.rgb == first.rgb) << impulse_text(impulse) << ", " << threads;
        }
    }
}

TEST_F(ImpulseFocus, RefusesWhatIsNoAperture) {
    const auto code = [](const Impulse& impulse) {
        try {
            (void)focused(impulse, 1.6);
        } catch (const Error& e) {
            return e.code();
        }
        return ExitCode::ok;
    };
    EXPECT_EQ(code({.kind = ImpulseKind::picture, .file = folder_->path() / "missing.png"}),
              ExitCode::invalid_input);
    std::ofstream(folder_->path() / "black.pgm") << "P2 2 2 255 0 0 0 0";
    EXPECT_EQ(code({.kind = ImpulseKind::picture, .file = folder_->path() / "black.pgm"}),
              ExitCode::invalid_input);
    EXPECT_EQ(code({.kind = ImpulseKind::picture, .file = folder_->path()}), ExitCode::invalid_input);
    EXPECT_EQ(code({.squeeze = -1}), ExitCode::wrong_arguments);
}

}  // namespace
}  // namespace postlens::test::impulse_focus_test
