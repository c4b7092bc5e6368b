// Kernels over the pixels of a view give what plain loops give.
#include "reproject/patches/seen_light.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
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

TEST(SeenLight, IsTheSumThatItSays) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> value(0, 3);
    std::vector<Texel> texels(300);
    for (Texel& t : texels)
        t = {value(random), value(random), value(random), static_cast<std::uint32_t>(random())};
    SeenTile seen;
    for (std::uint32_t& t : seen.texel) t = random() % 5 == 0 ? SeenTile::no_texel : random() % 300;
    LightSums sums{}, expected{};
    constexpr int across = 61, down = 33;
    std::vector<std::uint16_t> with_children;
    for (const double weight : {1.0, 0.3}) {
        PixelList listed;
        add_seen_light(texels, seen, across, down, weight, sums, listed);
        with_children.clear();
        for (int y = 0; y < down; ++y) {
            for (int x = 0; x < across; ++x) {
                const auto k = static_cast<std::size_t>(y * SeenTile::edge + x);
                if (seen.texel[k] == SeenTile::no_texel) continue;
                const Texel& t = texels[seen.texel[k]];
                expected[k][0] += weight * static_cast<double>(t.r);
                expected[k][1] += weight * static_cast<double>(t.g);
                expected[k][2] += weight * static_cast<double>(t.b);
                expected[k][3] += weight;
                if (t.children() != 0) with_children.push_back(static_cast<std::uint16_t>(k));
            }
        }
        EXPECT_TRUE(std::equal(listed.begin(), listed.end(), with_children.begin(), with_children.end()));
    }
    EXPECT_EQ(sums, expected);
}

TEST(SeenLight, ListsPixelsInDoubt) {
    RandomView view;
    SeenTile& seen = *view.seen;
    seen.inverse_z[0] = seen.maybe_inverse_z[0];
    seen.inverse_z[1] = std::numeric_limits<float>::quiet_NaN();
    for (const int width : {1, 15, 16, 17, SeenTile::edge}) {
        for (const std::uint32_t doubts :
             {0U, Texel::unsure_bit, Texel::unsure_below_bit | Texel::children_bits}) {
            std::vector<std::uint16_t> expected;
            const int height = width == SeenTile::edge ? width : width + 3;
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

TEST(SeenLight, ListsAllPixelsOfAnEmptyTile) {
    const auto seen = std::make_unique<SeenTile>();
    seen->clear();
    PixelList found;
    find_doubtful_pixels({}, *seen, SeenTile::edge, SeenTile::edge, Texel::unsure_bit, found);
    ASSERT_EQ(found.count, SeenTile::pixels);
    for (std::size_t k = 0; k < SeenTile::pixels; ++k) EXPECT_EQ(found.pixels[k], k);
}

}  // namespace postlens::test::seen_light_test
