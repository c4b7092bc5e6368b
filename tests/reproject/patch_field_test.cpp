// The mean of the views of patches.
#include "reproject/patch_field.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <iterator>
#include <mutex>
#include <span>
#include <vector>

#include "core/sample_hash.h"
#include "records/record.h"
#include "reproject/no_rays.h"
#include "reproject/patches/patches.h"
#include "reproject/raster_map.h"
#include "reproject/sight_rays.h"
#include "tests/reproject/made_sheets.h"

namespace postlens::test::patch_field_test {
namespace {

TEST(PatchField, AMotionAndItsLensAreOneMap) {
    const MadeSheets f({.levels = 1}, [](Record& r) {
        r.id = 5;
        r.z = 2;
    });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {10, 0.1});
    glm::dmat4 m(0.5);  // 3 px to the right, at half of the depth
    m[2][0] = 1.5;
    m[3][3] = 1;
    const LensShift shift{{8, 0}, 0.1, {}};
    for (const Patch& p : mesh.patches) {
        PatchPlace place;
        ASSERT_TRUE(place_patch(mesh, p, RasterMap(m, Projection::perspective), shift, place));
        EXPECT_NEAR(place.from.x, mesh.corner(p).x + 3 + (0.1 - 1.0) * 8, 1e-4);
        EXPECT_NEAR(place.inverse_z.x, 1, 1e-6);
    }
}

TEST(PatchField, WhatIsNotWantedStaysUnknown) {
    const MadeSheets f({.levels = 1}, [](Record& r) { r.id = 5; });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {1, 0.1});
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.width = width;
    field.height = height;
    PatchView v;
    v.uses = {{0, 1, {}}};
    field.sets.resize(2);
    for (PatchViews& set : field.sets) set.views = {v};
    field.sets[0].wanted = [](int, int, int, int) { return false; };
    field.sets[1].picture = 1;
    std::vector<PatchPicture> pictures(2, PatchPicture(width, height));
    patch_field(field, pictures);
    for (const float u : pictures[0].unknown) EXPECT_EQ(u, 1);
    for (const float u : pictures[1].unknown) EXPECT_EQ(u, 0);
}

/// Records the lines that are traced.
class NotedLines : public NoRays {
  public:
    void trace(std::span<const SightLine> lines, const LightElsewhere& less,
               std::span<std::array<float, 3>> radiance) const override {
        const std::scoped_lock lock(mutex_);
        noted_.insert(noted_.end(), lines.begin(), lines.end());
        NoRays::trace(lines, less, radiance);
    }
    [[nodiscard]] const std::vector<SightLine>& noted() const { return noted_; }

  private:
    mutable std::mutex mutex_;
    mutable std::vector<SightLine> noted_;
};

// A check ray follows the line of its view, with the light and lobe samples of the view's set.
TEST(PatchField, ChecksLookAlongTheLinesOfTheirViews) {
    const MadeSheets f({.levels = 1}, [](Record& r) { r.id = 5; });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {1, 0.1});
    NotedLines rays;
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.width = width;
    field.height = height;
    field.recorded_end = {width, height};
    field.sets.resize(1);
    for (const double at : {0.25, 0.75}) {
        PatchView v;
        v.sample = v.lens_point = glm::dvec2(at);
        v.light_before = at;
        v.set = 7;
        v.number = static_cast<std::uint32_t>(field.sets[0].views.size());
        v.uses = {{0, 1, {}}};
        field.sets[0].views.push_back(v);
    }
    field.sets[0].rays = &rays;
    field.sets[0].checked = [](int, int, std::vector<std::uint32_t>& views) { views = {0, 1}; };
    std::vector<PatchPicture> pictures(1, PatchPicture(width, height));
    patch_field(field, pictures);
    // Every view sample of every pixel is either replaced or checked by a ray.
    EXPECT_EQ(rays.noted().size(), static_cast<std::size_t>(2 * width * height));
    for (const SightLine& line : rays.noted()) {
        ASSERT_EQ(line.set, 7U);
        ASSERT_LT(line.view, 2U);
        const double at = line.view == 0 ? 0.25 : 0.75;
        EXPECT_EQ(line.place, glm::dvec2(at));
        EXPECT_EQ(line.lens, glm::dvec2(at));
        EXPECT_EQ(line.light_before, at);
    }
}

/// Rays that all see the same radiance.
class EvenRays : public NoRays {
  public:
    explicit EvenRays(float radiance) : radiance_(radiance) {}
    void trace(std::span<const SightLine>, const LightElsewhere&,
               std::span<std::array<float, 3>> radiance) const override {
        for (std::array<float, 3>& r : radiance) r.fill(radiance_);
    }

  private:
    float radiance_;
};

// A view between two recorded instants shows a mixture of both, so this mixture is what a check ray must see.
TEST(PatchField, ChecksCompareAMixtureOfTwoInstants) {
    const auto made = [](float radiance) {
        return MadeSheets({.levels = 1}, [=](Record& r) {
            r.id = 5;
            r.r = r.g = r.b = radiance;
        });
    };
    const MadeSheets before = made(0.2F), after = made(0.8F);
    const PatchMesh first = cut_patches(before.sheets.primary, {1, 0.1}),
                    second = cut_patches(after.sheets.primary, {1, 0.1});
    const EvenRays rays(0.65F);
    PatchField field;
    field.instants = {{&first, nullptr}, {&second, nullptr}};
    field.width = width;
    field.height = height;
    field.recorded_end = {width, height};
    field.sets.resize(1);
    PatchView v;
    v.uses = {{0, 0.25, {}}, {1, 0.75, {}}};
    field.sets[0].views = {v};
    field.sets[0].rays = &rays;
    field.sets[0].checked = [](int, int, std::vector<std::uint32_t>& views) { views = {0}; };
    std::vector<PatchPicture> pictures(1, PatchPicture(width, height));
    patch_field(field, pictures);
    std::uint32_t checked = 0;
    for (const PixelCheck& check : pictures[0].checks) {
        checked += check.rays;
        EXPECT_NEAR(check.mean(1), 0, 1e-6);
    }
    EXPECT_GE(checked, 100U);
}

/// Rays that take as long as 32 patches.
class CostlyRays : public NoRays {
  public:
    [[nodiscard]] std::size_t patches_per_ray() const override { return 32; }
};

MadeSheets reflecting_sheets() {
    return MadeSheets({.has_w = true}, [](Record& r) {
        r.id = 5;
        r.z = 2;
        r.r = r.g = r.b = 0.5F;
        r.w = Mat2::isotropic(r.path.bits() == 0 ? 0.5F : 0.3F);
    });
}

/// Two pictures of equal views of one instant: by rays and records, and by records alone.
std::vector<PatchPicture> by_rays_and_records(const PatchInstant& instant, const glm::dvec2& sample,
                                              int views, int piece_px) {
    const CostlyRays rays;
    PatchField field;
    field.instants = {instant};
    field.width = width;
    field.height = height;
    field.recorded_end = {width, height};
    field.piece_px = piece_px;
    PatchView v;
    v.sample = sample;
    v.uses = {{0, 1, {}}};
    field.sets.resize(2);
    for (std::size_t i = 0; i < 2; ++i) {
        field.sets[i].views.assign(static_cast<std::size_t>(views), v);
        field.sets[i].picture = i;
    }
    field.sets[0].rays = &rays;
    std::vector<PatchPicture> pictures(2, PatchPicture(width, height));
    patch_field(field, pictures);
    return pictures;
}

// If a piece has too many reflected and transmitted patches per pixel, rays replace the samples of all
// surfaces that need them, and no others. Sets without rays draw the patches.
TEST(PatchField, RaysReplaceCrowdedReflections) {
    const MadeSheets f = reflecting_sheets();
    const PatchMesh primary = cut_patches(f.sheets.primary, {6, 0.1}),
                    deeper = cut_patches(f.sheets.deeper, {6, 0.1});
    ASSERT_FALSE(deeper.patches.empty());
    const glm::dvec2 sample(0.3, 0.6);
    SeenTile seen;
    seen.clear();
    for (const Patch& p : primary.patches) {
        PatchPlace place;
        ASSERT_TRUE(place_patch(primary, p, {}, {}, place));
        draw_patch(primary, p, place, {0, 0, width, height, sample}, seen);
    }
    // The left pieces are crowded by copies of patches.
    constexpr int piece_px = 16, crowded_to_px = 12;
    const auto drawn = [&](std::size_t copies) {
        PatchMesh crowded = deeper;
        for (std::size_t i = 1; i < copies; ++i) {
            std::copy_if(deeper.patches.begin(), deeper.patches.end(), std::back_inserter(crowded.patches),
                         [&](const Patch& p) { return deeper.corner(p).x < crowded_to_px; });
        }
        return by_rays_and_records({&primary, &crowded}, sample, 1, piece_px);
    };
    const auto few = drawn(1), many = drawn(100 * width * height / deeper.patches.size());
    EXPECT_EQ(few[1].image.rgb, many[1].image.rgb);
    int parents = 0, by_records = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto p = static_cast<std::size_t>(y * width + x);
            const std::uint32_t texel = seen.texel[static_cast<std::size_t>(y * SeenTile::edge + x)];
            const bool parent =
                x < piece_px && texel != SeenTile::no_texel && primary.drawn_children(texel) != 0;
            EXPECT_EQ(many[0].traced[p], parent ? 1.0F : few[0].traced[p]);
            parents += parent ? 1 : 0;
            by_records += parent && few[0].traced[p] == 0 ? 1 : 0;
        }
    }
    EXPECT_GT(parents, piece_px * height / 10);
    EXPECT_GT(by_records, 0);
}

// Where the records determine what less than half of a piece's samples reflect or transmit, rays replace the
// samples of all surfaces that reflect or transmit from the ninth view on.
TEST(PatchField, RaysReplaceReflectionsThatAreRarelySure) {
    const MadeSheets f = reflecting_sheets();
    const PatchMesh primary = cut_patches(f.sheets.primary, {6, 0.1}),
                    deeper = cut_patches(f.sheets.deeper, {6, 0.1});
    const auto traced = [&](int views, bool bends) {
        PatchMesh reflected = deeper;
        for (Patch& p : reflected.patches) p.bent = p.bent || bends;
        return by_rays_and_records({&primary, &reflected}, {0.3, 0.6}, views, SeenTile::edge)[0].traced;
    };
    const auto few = traced(8, false), more = traced(12, false), of_all = traced(12, true);
    int reflecting = 0, sure = 0;
    for (std::size_t p = 0; p < few.size(); ++p) {
        reflecting += of_all[p] == 1 ? 1 : 0;
        const bool is_sure = of_all[p] == 1 && few[p] == 0;
        sure += is_sure ? 1 : 0;
        EXPECT_FLOAT_EQ(more[p], is_sure ? 4.0F / 12 : few[p]);
    }
    EXPECT_GT(sure, 0);
    EXPECT_LT(2 * sure, reflecting);
}

/// Highlights that add a light of 2 to every pixel. Lines that are aimed at them stand for a light of 3 if
/// nothing hides it.
class MadeLights : public Lights {
  public:
    [[nodiscard]] bool reach(int, int, int, int) const override { return true; }
    void add(const TileViews& views, std::vector<double>& light) const override {
        for (int y = 0; y < views.height; ++y) {
            for (int x = 0; x < views.width; ++x) {
                const auto pixel = static_cast<std::size_t>(y) * TileViews::row + static_cast<std::size_t>(x);
                for (std::size_t c = 0; c < 3; ++c) light[values * pixel + c] += 2;
            }
        }
    }
    [[nodiscard]] std::vector<std::uint32_t> reaching(int, int, int, int) const override { return {7}; }
    void aim(int x, int, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
             std::vector<Line>& lines) const override {
        ASSERT_EQ(sources.size(), 1U);
        for (int n = 0; n < count; ++n) {
            const double random =
                static_cast<double>(unit_float(random_word(seed, static_cast<std::uint32_t>(n))));
            lines.push_back({{.lens = {x, random}}, {}, 3});
        }
    }
};

/// The highlights are seen from x >= 4 on, for x >= 8 by a fifth of the lines.
class PartlyHidden : public SightRays {
  public:
    void trace(std::span<const SightLine>, const LightElsewhere&,
               std::span<std::array<float, 3>> radiance) const override {
        std::fill(radiance.begin(), radiance.end(), std::array<float, 3>{});
    }
    void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                         const LightElsewhere&, std::span<std::array<float, 3>> radiance) const override {
        ASSERT_EQ(of.size(), lines.size());
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const bool is_seen = lines[i].lens.x >= 8 ? lines[i].lens.y < 0.2 : lines[i].lens.x >= 4;
            radiance[i].fill(is_seen ? 1 : 0);
        }
    }
    void inverse_depths(std::span<const SightLine>, std::uint32_t,
                        std::span<glm::dvec3> inverse_z) const override {
        std::fill(inverse_z.begin(), inverse_z.end(), glm::dvec3(0));
    }
    [[nodiscard]] bool steady(NodePath, std::uint32_t) const override { return true; }
};

TEST(PatchField, ChecksHighlightsByLinesThatAreAimedAtThem) {
    const MadeSheets f({.levels = 1}, [](Record& r) { r.id = 5; });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {1, 0.1});
    const MadeLights lights;
    const PartlyHidden rays;
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.width = width;
    field.height = height;
    field.recorded_end = {width, height};
    field.sets.resize(1);
    PatchView v;
    v.uses = {{0, 1, {}}};
    PatchViews& set = field.sets[0];
    set.views = {v};
    set.lights = &lights;
    set.rays = &rays;
    set.checked = [](int, int, std::vector<std::uint32_t>&) {};
    set.aimed = [](int x, int) { return x == 5 ? 0 : 0.5; };
    std::vector<PatchPicture> pictures(1, PatchPicture(width, height));
    patch_field(field, pictures);
    double sum = 0;
    int pixels = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const HighlightCheck& check =
                pictures[0].highlight_checks[static_cast<std::size_t>(y * width + x)];
            SCOPED_TRACE(x);
            EXPECT_EQ(check.light[1], 2);
            EXPECT_EQ(check.aimed_share, x == 5 ? 0 : 0.5F);
            if (x < 8) {
                EXPECT_EQ(check.aimed, x == 5 ? 0U : 4U);
                EXPECT_EQ(check.residual(1), x == 5 ? 0 : x >= 4 ? 3 - 2 : -2);
                continue;
            }
            // Where few rays differ, more are traced.
            EXPECT_TRUE(check.aimed == 4 || check.aimed == 28) << check.aimed;
            sum += check.residual(1);
            ++pixels;
        }
    }
    // The mean of 960 pixels has a standard error of at most 3 sqrt(0.2 * 0.8 / 4 / 960) = 0.02. If the rays
    // that decide were counted as well, it would be 0.2 too small.
    EXPECT_NEAR(sum / pixels, 3 * 0.2 - 2, 0.06);
}

}  // namespace
}  // namespace postlens::test::patch_field_test
