// The refocused Cryptomatte against the mattes of single objects by rays through the lens.
#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "focus/focus_passes.h"
#include "focus/foreign_focus.h"
#include "pictures/foreign/cryptomatte.h"
#include "pictures/stacks/lay_behind.h"
#include "pictures/stacks/unmix_edges.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/render.h"

namespace postlens::test::mattes_focus_test {
namespace {

constexpr int width = 160, height = 120, overscan = 12;
constexpr double film_mm = 36, film_distance_mm = 50, focus_m = 4, f_number = 0.5;

/// Objects perpendicular to the axis. Each emits in a channel of its own and is black in the others, so that
/// each channel of an image is the matte of one object, with the others as holdouts.
constexpr std::array<double, 3> depth_m{1.5, focus_m, 20};
const std::array<std::string, 3> names{"bar", "disc", "wall"};

/// The bar hides a part of the disc, and both hide a part of the wall. The circles of confusion have a
/// diameter of 9 px on the bar and 4 px on the wall.
SceneBuilder objects(bool with_bar) {
    SceneBuilder b;
    const double z = -depth_m[0];
    if (with_bar) b.add(Rectangle{{-0.5, -0.5, z}, {0.09, -0.04, 0}, {0.8, 1.8, 0}}, glowing({1, 0, 0}));
    b.add(Disc{{0.1, 0.05, -depth_m[1]}, {0, 0, 1}, 0.5}, glowing({0, 1, 0}));
    b.add(square({0, 0, -depth_m[2]}, {0, 0, 1}, 60), glowing({0, 0, 1}));
    return b;
}

class MattesTest : public testing::Test {
  protected:
    RenderResult render(const SceneBuilder& of, RenderSettings settings) {
        settings.camera.film_distance_mm = film_distance_mm;
        return render_to_file(of.scene, settings, folder_.path() / "rays.exr");
    }
    /// An image as another program renders it through a pinhole: flat, with the depth and the id of the
    /// object that fills most of a pixel, and with a Cryptomatte.
    ForeignPicture picture(bool with_bar) {
        const int wide = width + 2 * overscan, tall = height + 2 * overscan;
        const Image shares =
            render(objects(with_bar),
                   {.camera = {.width = wide, .height = tall, .film_width_mm = film_mm * wide / width},
                    .f_number = std::numeric_limits<double>::infinity(),
                    .spp = 256})
                .image;
        ForeignPicture p;
        p.width = width;
        p.height = height;
        p.x_begin = p.y_begin = -overscan;
        p.x_end = width + overscan;
        p.y_end = height + overscan;
        p.camera.film_width_mm = film_mm;
        p.camera.film_distance_mm = film_distance_mm;
        p.channels.matte = Cryptomatte{"CryptoObject", {}, "{}"};
        for (std::size_t pixel = 0; pixel < shares.rgb.size() / 3; ++pixel) {
            const float* share = &shares.rgb[3 * pixel];
            const auto most = static_cast<std::size_t>(std::max_element(share, share + 3) - share);
            p.samples.push_back({.inverse_z = static_cast<float>(1 / depth_m[most]),
                                 .r = share[0],
                                 .g = share[1],
                                 .b = share[2],
                                 .id = cryptomatte_id(names[most])});
            p.offsets.push_back(p.samples.size());
            const std::size_t first = p.shares.size();
            for (std::size_t i = 0; i < 3; ++i) {
                constexpr float least_share = 0.01F;
                if (share[i] >= least_share) p.shares.push_back({cryptomatte_id(names[i]), share[i], {}});
            }
            if (p.shares.size() - first > 1) {
                p.mixed.push_back({pixel, first, p.shares.size() - first});
            } else {
                p.shares.resize(first);
            }
        }
        unmix_edges(p);
        return p;
    }
    TemporaryFolder folder_;
};

/// Coverage of an object in every pixel.
std::vector<double> coverage(const Image& image, const std::string& name) {
    std::vector<double> out(image.rgb.size() / 3, 0.0);
    for (std::size_t plane = 0; plane < image.planes.size(); plane += 2) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            if (std::bit_cast<std::uint32_t>(image.planes[plane].values[i]) == cryptomatte_id(name))
                out[i] += static_cast<double>(image.planes[plane + 1].values[i]);
        }
    }
    return out;
}

/// Mean squared error of a matte against the mean of two independent halves of the true one, and the part of
/// it that is the noise of that mean.
struct MatteError {
    double square = 0, noise = 0;
};
MatteError error_of(const std::vector<double>& made, const std::array<Image, 2>& halves,
                    std::size_t channel) {
    MatteError out;
    for (std::size_t i = 0; i < made.size(); ++i) {
        const auto a = static_cast<double>(halves[0].rgb[3 * i + channel]),
                   b = static_cast<double>(halves[1].rgb[3 * i + channel]);
        const double d = made[i] - (a + b) / 2;
        out.square += d * d / static_cast<double>(made.size());
        out.noise += (a - b) * (a - b) / 4 / static_cast<double>(made.size());
    }
    return out;
}

TEST_F(MattesTest, EachIsThatOfTheObjectRenderedAloneThroughTheLens) {
    const std::array<Image, 2> truth = render(objects(true), {.camera = {.width = width, .height = height},
                                                              .f_number = f_number,
                                                              .focus_m = focus_m,
                                                              .spp = 512,
                                                              .halves = true})
                                           .halves;
    const ForeignPicture alone = picture(true);
    ForeignPicture stacked = alone;
    lay_behind(stacked, picture(false), "behind");
    constexpr double at_40_db = 1e-4, at_36_db = 2.5e-4;
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::scatter, FocusMethod::lightfield}) {
        const FocusSettings settings{.lens = {film_distance_mm, f_number},
                                     .focus_distance_m = focus_m,
                                     .method = method,
                                     .views = 128};
        for (const bool is_stacked : {false, true}) {
            const ForeignPicture& p = is_stacked ? stacked : alone;
            Image image = focus_foreign(p, settings).image;
            add_focus_passes(p, settings, {.cryptomatte = true}, image);
            for (std::size_t c = 0; c < names.size(); ++c) {
                const MatteError e = error_of(coverage(image, names[c]), truth, c);
                // The rays' noise is near 55 dB, and stays below a tenth of the bound.
                ASSERT_LT(e.noise, at_40_db / 10) << names[c];
                // Without the second picture, the rim of the disc behind the bar is not known: 37.6 dB.
                EXPECT_LT(e.square - e.noise, is_stacked || c == 0 ? at_40_db : at_36_db) << names[c];
            }
        }
    }
}

}  // namespace
}  // namespace postlens::test::mattes_focus_test
