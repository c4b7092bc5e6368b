// Kernels over the pixels of a view give what plain loops give.
#include "reproject/patches/seen_light.h"

#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

namespace postlens::test::seen_light_test {
namespace {

/// A tile of random pixels; every 8th shows nothing.
struct RandomView {
    std::mt19937 random{7};
    std::vector<Texel> texels = std::vector<Texel>(1000);
    std::unique_ptr<SeenTile> seen = std::make_unique<SeenTile>();

    RandomView() {
        std::uniform_real_distribution<float> unit(0, 1);
        for (Texel& t : texels) t = {unit(random), unit(random), unit(random), below(1U << 10U)};
        for (std::size_t k = 0; k < SeenTile::pixels; ++k) {
            seen->texel[k] = below(8) == 0 ? SeenTile::no_texel : below(1000);
            seen->inverse_z[k] = unit(random);
            seen->maybe_inverse_z[k] = below(4) == 0 ? unit(random) : SeenTile::nothing;
        }
    }
    std::uint32_t below(std::uint32_t end) {
        return std::uniform_int_distribution<std::uint32_t>(0, end - 1)(random);
    }
};

}  // namespace

TEST(SeenLight, ListsPixelsInDoubt) {
    const RandomView view;
    const SeenTile& seen = *view.seen;
    for (const int width : {1, 15, 16, 17, SeenTile::edge}) {
        for (const std::uint32_t doubts :
             {0U, Texel::unsure_bit, Texel::unsure_below_bit | Texel::children_bits}) {
            std::vector<std::uint16_t> expected;
            const int height = SeenTile::edge - width / 2;
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const auto k = static_cast<std::size_t>(y * SeenTile::edge + x);
                    if (seen.texel[k] == SeenTile::no_texel || seen.maybe_inverse_z[k] > seen.inverse_z[k] ||
                        (view.texels[seen.texel[k]].info & doubts) != 0)
                        expected.push_back(static_cast<std::uint16_t>(k));
                }
            }
            PixelList found;
            found.count = 3;
            find_doubtful_pixels(view.texels, seen, width, height, doubts, found);
            EXPECT_EQ(std::vector(found.begin(), found.end()), expected) << width << " px wide";
        }
    }
}

TEST(SeenLight, AddsTheColoursOfAView) {
    const RandomView view;
    const auto sums = std::make_unique<LightSums>(), expected = std::make_unique<LightSums>();
    constexpr int width = 37, height = 50;
    PixelList with_children;
    std::vector<std::uint16_t> parents;
    for (const double weight : {1.0, 0.3}) {
        parents.clear();
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto k = static_cast<std::size_t>(y * SeenTile::edge + x);
                if (view.seen->texel[k] == SeenTile::no_texel) continue;
                const Texel& t = view.texels[view.seen->texel[k]];
                const std::array<float, 4> light{t.r, t.g, t.b, 1};
                for (std::size_t c = 0; c < 4; ++c)
                    (*expected)[k][c] += weight * static_cast<double>(light[c]);
                if (t.children() != 0) parents.push_back(static_cast<std::uint16_t>(k));
            }
        }
        add_seen_light(view.texels, *view.seen, width, height, weight, *sums, with_children);
    }
    EXPECT_EQ(*sums, *expected);
    EXPECT_EQ(std::vector(with_children.begin(), with_children.end()), parents);
}

}  // namespace postlens::test::seen_light_test
