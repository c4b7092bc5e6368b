// The noise that the two halves of one image state for its tiles, compared with the spread of several images
// that have independent lens points.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "pictures/crop.h"
#include "pictures/srgb.h"
#include "planner/stated_error.h"
#include "planner/views/halved_views.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"
#include "tracer/trace.h"

namespace postlens::test::stated_noise_test {
namespace {

constexpr int width = 256, height = 192, images = 5;

struct Lens {
    const char* scene;
    double f_number, focus_m;
};

/// Images of 32 views each, and for each image the stated error of every tile.
struct Images {
    std::vector<Image> image;
    std::vector<std::vector<StatedError>> stated;
};

Images draw(const SampleFileReader& file, const Lens& lens) {
    FocusFrame frame(file);
    HybridSettings settings;
    settings.focus = {.lens = {.focal_length_mm = 50, .f_number = lens.f_number},
                      .focus_distance_m = lens.focus_m};
    Images out;
    for (int i = 0; i < images; ++i) {
        HalvedViews views(frame, settings, 128 * i);
        views.draw(std::vector<int>(views.grid().count(), 32));
        out.stated.emplace_back();
        for (int y = 0; y < height; y += TileGrid::edge) {
            for (int x = 0; x < width; x += TileGrid::edge)
                out.stated.back().push_back(stated_error(
                    measured_error(views.half(0), views.half(1), Crop{x, y, TileGrid::edge, TileGrid::edge},
                                   views.checked_pixels(), CheckedPixels::Use::stating)));
        }
        out.image.push_back(std::move(views).whole().image);
    }
    return out;
}

/// Squared errors of each image in each tile, in sRGB values. The reference is the mean of the other images;
/// its own noise, which is a share 1 / (images - 1) of the image's, is subtracted.
std::vector<std::vector<double>> squared_errors(const Images& drawn) {
    const TileGrid grid{width, height};
    std::vector<std::vector<double>> out(images, std::vector<double>(grid.count(), 0));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const std::size_t tile = grid.at(x, y);
            for (std::size_t c = 0; c < 3; ++c) {
                std::vector<double> value;
                double sum = 0;
                for (const Image& image : drawn.image) {
                    value.push_back(
                        static_cast<double>(srgb_from_linear(std::clamp(image.pixel(x, y)[c], 0.0F, 1.0F))));
                    sum += value.back();
                }
                for (std::size_t i = 0; i < images; ++i) {
                    const double difference = value[i] - (sum - value[i]) / (images - 1);
                    out[i][tile] +=
                        difference * difference * (images - 1) / images / (3.0 * grid.pixels(tile));
                }
            }
        }
    }
    return out;
}

// 240 tiles of 20 images are compared. Three statements are tested.
// - The 95 % interval of a tile contains the tile's error.
// - A tile whose interval implies a standard deviation of at most 0.5 dB for the noise estimate (1.96 of them
//   are 1 dB) states its noise to 1 dB in 95 % of the cases.
// - The estimate has no bias: the mean ratio of stated to measured noise is 1.
TEST(StatedNoise, OfATileIsItsNoiseWithinTheStatedInterval) {
    const TemporaryFolder folder;
    int tiles = 0, covered = 0, certain = 0, within_1_db = 0;
    double ratios = 0;
    for (const Lens& lens :
         {Lens{"bars.toml", 1.4, 5}, {"bars.toml", 4, 1.5}, {"night.toml", 1.4, 5}, {"night.toml", 4, 1.5}}) {
        TraceSettings trace;
        trace.camera.width = width;
        trace.camera.height = height;
        trace.subdivision.levels = 1;
        trace.for_f_number = lens.f_number;
        const auto path = folder.path() / "frame.exr";
        trace_to_file(read_scene(std::filesystem::path(POSTLENS_SAMPLES) / "scenes" / lens.scene), trace,
                      path);
        const Images drawn = draw(SampleFileReader(path), lens);
        const auto errors = squared_errors(drawn);
        for (std::size_t t = 0; t < errors[0].size(); ++t) {
            double noise = 0;
            for (const auto& of_image : errors) noise += of_image[t] / images;
            if (noise < 1e-9) continue;  // 90 dB: rounding, not noise
            for (std::size_t i = 0; i < images; ++i) {
                const StatedError& stated = drawn.stated[i][t];
                const double off_db = std::abs(10 * std::log10(stated.views_mse / noise));
                // The interval is 2 * 1.96 standard deviations wide. Its variance is the sum of two equal
                // ones: of the estimate and of the image itself.
                const double deviation_db =
                    (stated.high_db() - stated.low_db()) / (2 * 1.96 * std::sqrt(2.0));
                ++tiles;
                covered += errors[i][t] >= stated.low_mse && errors[i][t] <= stated.high_mse ? 1 : 0;
                certain += deviation_db <= 0.5 ? 1 : 0;
                within_1_db += deviation_db <= 0.5 && off_db <= 1 ? 1 : 0;
                ratios += stated.views_mse / noise;
            }
        }
    }
    ASSERT_GE(tiles, 200);
    EXPECT_GE(covered, 0.95 * tiles);
    EXPECT_GE(within_1_db, 0.95 * certain);
    EXPECT_NEAR(ratios / tiles, 1, 0.05);
}

}  // namespace
}  // namespace postlens::test::stated_noise_test
