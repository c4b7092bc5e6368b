// Reflected and transmitted images that move almost like the surface itself are treated as the surface's own
// radiance.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "reproject/patch_field.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/sheets/sample_surfaces.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::following_light_test {
namespace {

constexpr int width = 70, height = 40, overscan = 4;
constexpr NodePath seen_directly, mirrored(1), twice_mirrored(5), through(2);
constexpr float z = 2, far_off_per_m = 0.3F;

/// A pane that shows everywhere a mirror, a second surface in that mirror, and a surface behind the glass.
struct Pane {
    /// `parts_per_m`: difference between W of each mirror's image and W of the mirror itself. `mirrored_red`:
    /// radiance of the surface in the second mirror.
    explicit Pane(float parts_per_m, float mirrored_red = 0.2F) {
        const RandomOptions options{.levels = 0, .has_w = true};
        SampleHeader h = full_header(width, height, overscan, options);
        std::mt19937 random(1);
        RecordBand places = random_frame(random, h, options), band = places;
        band.records.clear();
        band.offsets.assign(1, 0);
        for (std::size_t pixel = 0; pixel + 1 < places.offsets.size(); ++pixel) {
            Record r = places.records[places.offsets[pixel]];
            const auto add = [&](NodePath path, std::uint32_t id, float w, float red) {
                r.path = path;
                r.id = id;
                r.z = 1 / w;
                r.w = Mat2::isotropic(w);
                r.r = red;
                r.g = 0.3F + 0.01F * r.x / static_cast<float>(id);
                r.b = 0.4F - 0.005F * r.y / static_cast<float>(id);
                r.w_bend = 0;
                band.records.push_back(r);
            };
            add(seen_directly, 1, 1 / z, 0.1F);
            add(mirrored, 2, 1 / z + parts_per_m, 0.05F);
            add(through, 3, 1 / z - far_off_per_m, 0.5F);
            add(twice_mirrored, 4, 1 / z + 2 * parts_per_m, mirrored_red);
            band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
        }
        const std::filesystem::path path = folder.path() / "pane.exr";
        SampleFileWriter writer(path, h, RecordCompression::none);
        writer.write(band);
        writer.finish();
        sheets = tree_sheets(SampleFileReader(path), 0, {});
    }

    [[nodiscard]] PatchPicture seen(const PatchLens& lens) const {
        const PatchMesh primary = cut_patches(sheets.primary, lens),
                        deeper = cut_patches(sheets.deeper, lens);
        PatchField field;
        field.instants = {{&primary, &deeper}};
        field.width = width;
        field.height = height;
        PatchViews set;
        for (int i = 0; i < 12; ++i) {
            PatchView v;
            const double turn = 2.4 * i, out = lens.radius_px_m * std::sqrt((i + 0.5) / 12);
            v.lens = {{out * std::cos(turn), out * std::sin(turn)}, lens.inverse_focus_per_m, {}};
            v.sample = {std::fmod(0.755 * i + 0.03, 1.0), std::fmod(0.57 * i + 0.01, 1.0)};
            v.uses = {{0, 1, {}}};
            set.views.push_back(v);
        }
        field.sets = {set};
        std::vector<PatchPicture> pictures(1, PatchPicture(width, height));
        patch_field(field, pictures);
        return pictures[0];
    }

    TemporaryFolder folder;
    TreeSheets sheets;
};

TEST(FollowingLight, SheetsSayHowFarWhatTheyShowPartsFromThem) {
    const float parts = 0.01F;
    const Pane pane(parts);
    ASSERT_FALSE(pane.sheets.primary.sheets.empty());
    for (const Sheet& s : pane.sheets.primary.sheets) {
        EXPECT_NEAR(s.strays[0], 2 * parts, 1e-6F);
        EXPECT_NEAR(s.strays[1], far_off_per_m, 1e-6F);
    }
    for (const Sheet& s : pane.sheets.deeper.sheets) {
        EXPECT_NEAR(s.strays[0], s.key.path == mirrored ? parts : 0, 1e-6F);
        EXPECT_EQ(s.strays[1], 0);
    }
}

// With a lens of 10 px m, the image in the second mirror is displaced by 0.2 px. The result must equal that
// of mirrors that are reprojected separately and have the W of the pane; the surface behind the pane stays.
TEST(FollowingLight, IsWhereItsMirrorIs) {
    PatchLens lens{10, 0.4};
    const PatchPicture follows = Pane(0.01F).seen(lens);
    lens.follow_px = -1;
    const PatchPicture drawn = Pane(0).seen(lens);
    // Positions are rounded, so a few pixels next to the border of two squares show the other square.
    std::size_t others = 0;
    for (std::size_t i = 0; i < follows.image.rgb.size(); ++i) {
        if (std::abs(follows.image.rgb[i] - drawn.image.rgb[i]) > 1e-5F) ++others;
    }
    EXPECT_LT(others, follows.image.rgb.size() / 1000);
    // In the interior, every view finds a surface.
    for (int y = 10; y < height - 10; ++y) {
        for (int x = 10; x < width - 10; ++x)
            EXPECT_EQ(
                follows.unknown_below[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)], 0);
    }
}

// Colours are constant in squares of one pixel, so a view may see the next square within 0.25 px of a border.
TEST(FollowingLight, IsHardlyElsewhereThanDrawnForItself) {
    PatchLens lens{10, 0.4};
    const Pane pane(0.01F);
    const PatchPicture follows = pane.seen(lens);
    lens.follow_px = -1;
    const PatchPicture drawn = pane.seen(lens);
    double most = 0;
    for (int y = 10; y < height - 10; ++y) {
        for (int x = 10; x < width - 10; ++x) {
            for (int c = 0; c < 3; ++c)
                most = std::max(most, std::abs(static_cast<double>(follows.image.pixel(x, y)[c] -
                                                                   drawn.image.pixel(x, y)[c])));
        }
    }
    EXPECT_LT(most, 0.01 / 2 + 0.01 / 4);
    EXPECT_GT(most, 0);
}

TEST(FollowingLight, EndsWhereTheLensTellsThemApart) {
    const Pane pane(0.01F);
    PatchLens lens{12.4, 0.4};
    const auto follows = [&](const SheetMesh& sheets, NodePath path) {
        const PatchMesh mesh = cut_patches(sheets, lens);
        for (std::size_t i = 0; i < mesh.follows.size(); ++i) {
            if (sheets.sheets[i].key.path == path) return static_cast<int>(mesh.follows[i]);
        }
        return -1;
    };
    const int reflection = child_bit(NodePath::Bounce::reflected);
    EXPECT_EQ(follows(pane.sheets.primary, seen_directly), reflection);  // 0.248 px
    lens.radius_px_m = 12.6;
    EXPECT_EQ(follows(pane.sheets.primary, seen_directly), 0);
    EXPECT_EQ(follows(pane.sheets.deeper, mirrored) & reflection, reflection);  // 0.126 px
    lens.follow_px = -1;
    EXPECT_EQ(follows(pane.sheets.deeper, twice_mirrored), 0);
}

// A bright reflected image may be a highlight, which has its own response, so it is reprojected separately.
TEST(FollowingLight, IsNotBright) {
    const Pane pane(0, 1.5F);
    for (const SheetMesh* mesh : {&pane.sheets.primary, &pane.sheets.deeper}) {
        for (const Sheet& s : mesh->sheets) {
            const bool above = s.key.path == seen_directly || s.key.path == mirrored;
            EXPECT_EQ(s.strays[0], above ? HUGE_VALF : 0.0F);
        }
    }
}

TEST(PixelBlocks, HaveWhatAnyOfTheirPixelsHas) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-20, 84);
    std::uniform_int_distribution<int> pixel(0, SeenTile::edge - 1);
    constexpr int block = 8;
    for (int turn = 0; turn < 2000; ++turn) {
        PixelBlocks blocks;
        std::array<bool, 64> has{};
        for (int n = turn % 4; n > 0; --n) {
            const int x = pixel(random), y = pixel(random);
            blocks.add(x, y);
            has[static_cast<std::size_t>(y / block * 8 + x / block)] = true;
        }
        float x0 = place(random), x1 = place(random), y0 = place(random), y1 = place(random);
        if (x0 > x1) std::swap(x0, x1);
        if (y0 > y1) std::swap(y0, y1);
        bool expected = false;
        for (int k = 0; k < 64; ++k) {
            const auto left = static_cast<float>(k % 8 * block), top = static_cast<float>(k / 8 * block);
            expected = expected || (has[static_cast<std::size_t>(k)] && x1 >= left && x0 < left + block &&
                                    y1 >= top && y0 < top + block);
        }
        EXPECT_EQ(blocks.any_in(x0, x1, y0, y1), expected) << x0 << ' ' << x1 << ' ' << y0 << ' ' << y1;
    }
}

}  // namespace
}  // namespace postlens::test::following_light_test
