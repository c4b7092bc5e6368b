#include "records/quadtree.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/error.h"
#include "tests/support/random_records.h"

namespace postlens::test::quadtree_test {
namespace {

/// Weight and leaf size of a sample in each of its four quadrants.
struct Quadrants {
    std::array<double, 4> weight{};
    std::array<double, 4> leaf_size{};
};
using Reference = std::map<std::pair<int, int>, Quadrants>;  // by (y, x) in steps

Places places_of(const RecordBand& band) {
    Places places;
    for (const Record& r : band.records) {
        if (r.layer == 0) {
            places.insert({static_cast<int>(std::lround(r.y * steps_per_px)),
                           static_cast<int>(std::lround(r.x * steps_per_px))});
        }
    }
    return places;
}

/// The rule as specified, slow and simple: a cell with a centre sample is four cells, and a leaf gives a
/// quarter of its area to each corner.
void add_cell(const Places& places, int x, int y, int size, Reference& out) {
    const int half = size / 2;
    if (half > 0 && places.contains({y + half, x + half})) {
        for (const int dy : {0, half}) {
            for (const int dx : {0, half}) add_cell(places, x + dx, y + dy, half, out);
        }
        return;
    }
    const double edge = size / static_cast<double>(steps_per_px);
    const auto give = [&](int corner_x, int corner_y, std::size_t quadrant) {
        ASSERT_TRUE(places.contains({corner_y, corner_x}));
        Quadrants& q = out[{corner_y, corner_x}];
        q.weight[quadrant] += edge * edge / 4;
        q.leaf_size[quadrant] = edge;
    };
    give(x, y, 3);
    give(x + size, y, 2);
    give(x, y + size, 1);
    give(x + size, y + size, 0);
}

Reference reference_weights(const RecordBand& band, int pixel_y_begin, int pixel_y_end) {
    const Places places = places_of(band);
    Reference out;
    for (int y = pixel_y_begin; y < pixel_y_end; ++y) {
        for (int x = band.x_begin; x + 1 < band.x_end; ++x) {
            add_cell(places, x * steps_per_px, y * steps_per_px, steps_per_px, out);
        }
    }
    return out;
}

void expect_equal_reference(const PointSamples& got, const RecordBand& band, int y_begin, int y_end,
                            int pixel_y_begin, int pixel_y_end) {
    Reference reference = reference_weights(band, pixel_y_begin, pixel_y_end);
    const auto width = static_cast<std::size_t>(band.width());
    ASSERT_EQ(got.offsets.size(), width * static_cast<std::size_t>(y_end - y_begin) + 1);
    std::size_t k = 0;
    for (int y = y_begin; y < y_end; ++y) {
        for (int x = band.x_begin; x < band.x_end; ++x) {
            const std::size_t pixel =
                static_cast<std::size_t>(y - y_begin) * width + static_cast<std::size_t>(x - band.x_begin);
            ASSERT_EQ(got.offsets[pixel], k);
            // Every layer-0 record of the pixel belongs to one run.
            const std::size_t in_band = band.pixel(x, y);
            std::uint32_t next = band.offsets[in_band];
            for (; k < got.offsets[pixel + 1]; ++k) {
                const PointSample& s = got.samples[k];
                ASSERT_EQ(s.first_record, next);
                next += s.record_count;
                for (std::uint32_t i = s.first_record; i < next; ++i) {
                    ASSERT_EQ(band.records[i].x, s.x);
                    ASSERT_EQ(band.records[i].y, s.y);
                    ASSERT_EQ(band.records[i].layer, 0U);
                }
                const Quadrants& q = reference[{static_cast<int>(std::lround(s.y * steps_per_px)),
                                                static_cast<int>(std::lround(s.x * steps_per_px))}];
                for (std::size_t c = 0; c < 4; ++c) {
                    ASSERT_EQ(s.weight[c], q.weight[c]) << s.x << ' ' << s.y << ' ' << c;
                    ASSERT_EQ(s.leaf_size[c], q.leaf_size[c]) << s.x << ' ' << s.y << ' ' << c;
                }
            }
            ASSERT_TRUE(next == band.offsets[in_band + 1] || band.records[next].layer > 0);
        }
    }
    ASSERT_EQ(k, got.samples.size());
}

RecordBand make_band(int levels, double probability, unsigned seed) {
    std::mt19937 random(seed);
    return random_band(random, -2, 7, -1, 6,
                       {.levels = levels, .probability = probability, .has_w = true, .has_layers = true});
}

TEST(Quadtree, OneSampleAPixelWeighsAQuarterInEachOfItsFourPixels) {
    std::mt19937 random(1);
    const RecordBand band = random_band(random, 0, 4, 0, 4, {});
    PointSamples got;
    find_point_samples(band, 0, 4, 0, 3, got);
    ASSERT_EQ(got.samples.size(), 16U);
    const auto weights_at = [&](std::size_t x, std::size_t y) { return got.samples[4 * y + x].weight; };
    using W = std::array<float, 4>;
    EXPECT_EQ(weights_at(0, 0), (W{0, 0, 0, 0.25F}));
    EXPECT_EQ(weights_at(1, 0), (W{0, 0, 0.25F, 0.25F}));
    EXPECT_EQ(weights_at(3, 0), (W{0, 0, 0.25F, 0}));
    EXPECT_EQ(weights_at(2, 2), (W{0.25F, 0.25F, 0.25F, 0.25F}));
    EXPECT_EQ(weights_at(3, 3), (W{0.25F, 0, 0, 0}));
}

TEST(Quadtree, AHangingNodeHasNoWeightInTheCoarseLeaf) {
    // The left of two pixels is subdivided once. The midpoint of its right edge is no corner of a leaf in the
    // right pixel.
    Places places;
    for (int x = 0; x < 3; ++x) {
        for (int y = 0; y < 2; ++y) places.insert({y * 1024, x * 1024});
    }
    for (const auto& p : {std::pair(512, 512), {0, 512}, {1024, 512}, {512, 0}, {512, 1024}})
        places.insert(p);
    RecordBand band;
    band.x_end = 3;
    band.y_end = 2;
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 3; ++x) {
            for (const auto& [py, px] : places) {
                if (py / 1024 != y || px / 1024 != x) continue;
                Record r;
                r.x = static_cast<float>(px) / 1024;
                r.y = static_cast<float>(py) / 1024;
                r.z = 1;
                band.records.push_back(r);
            }
            band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
        }
    }
    PointSamples got;
    find_point_samples(band, 0, 2, 0, 1, got);
    const auto sample_at = [&](float x, float y) {
        for (const PointSample& s : got.samples) {
            if (s.x == x && s.y == y) return s;
        }
        ADD_FAILURE() << x << ' ' << y;
        return PointSample{};
    };
    using W = std::array<float, 4>;
    EXPECT_EQ(sample_at(0.5F, 0.5F).weight, (W{0.0625F, 0.0625F, 0.0625F, 0.0625F}));
    EXPECT_EQ(sample_at(0.5F, 0.5F).leaf_size, (W{0.5F, 0.5F, 0.5F, 0.5F}));
    EXPECT_EQ(sample_at(1, 0.5F).weight, (W{0.0625F, 0, 0.0625F, 0}));
    EXPECT_EQ(sample_at(1, 0.5F).leaf_size, (W{0.5F, 0, 0.5F, 0}));
    EXPECT_EQ(sample_at(1, 0).weight, (W{0, 0, 0.0625F, 0.25F}));
    EXPECT_EQ(sample_at(0, 0).weight, (W{0, 0, 0, 0.0625F}));
    EXPECT_EQ(sample_at(2, 1).weight, (W{0.25F, 0, 0, 0}));
}

TEST(Quadtree, EqualsTheReferenceForRandomTrees) {
    for (const int levels : {0, 1, 2, 3, 5, 6, 7}) {  // more than six levels use another lookup
        for (unsigned seed = 0; seed < 3; ++seed) {
            const RecordBand band = make_band(levels, 0.5, seed + 10);
            PointSamples got;
            for (int y_begin = band.y_begin; y_begin < band.y_end; ++y_begin) {
                for (int y_end = y_begin + 1; y_end <= band.y_end; ++y_end) {
                    find_point_samples(band, y_begin, y_end, band.y_begin, band.y_end - 1, got);
                    expect_equal_reference(got, band, y_begin, y_end, band.y_begin, band.y_end - 1);
                }
            }
            find_point_samples(band, 0, 5, 0, 4, got);  // only the raster's pixels, without overscan
            expect_equal_reference(got, band, 0, 5, 0, 4);
        }
    }
}

TEST(Quadtree, FinestLeavesAreOfOneStep) {
    Places places;
    std::mt19937 random(3);
    subdivide(places, random, 1.0, 1, 0, 0, steps_per_px);
    int x = 0, size = steps_per_px;
    while (size > 1) {  // divides the upper left quarter again
        size /= 2;
        for (const int dy : {0, size}) {
            for (const int dx : {0, size}) add_corners(places, x + dx, dy, size);
        }
    }
    RecordBand band;
    band.x_end = band.y_end = 2;
    for (const auto& [cell_y, cell_x] : {std::pair(0, 0), {0, 1}, {1, 0}, {1, 1}}) {
        for (const auto& [py, px] : places) {
            if (py / 1024 != cell_y || px / 1024 != cell_x) continue;
            Record r;
            r.x = static_cast<float>(px) / 1024;
            r.y = static_cast<float>(py) / 1024;
            r.z = 1;
            band.records.push_back(r);
        }
        band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
    }
    PointSamples got;
    find_point_samples(band, 0, 2, 0, 1, got);
    expect_equal_reference(got, band, 0, 2, 0, 1);
    EXPECT_EQ(got.samples[0].leaf_size[3], 1.0F / 1024);
}

TEST(Quadtree, WeightsInEveryPixelAddUpToOne) {
    const RecordBand band = make_band(4, 0.6, 77);
    PointSamples got;
    find_point_samples(band, band.y_begin, band.y_end, band.y_begin, band.y_end - 1, got);
    double sum = 0;
    for (const PointSample& s : got.samples) sum += static_cast<double>(s.total_weight());
    EXPECT_EQ(sum, 8.0 * 6.0);  // dyadic sums are exact
}

/// Weights times colours, pixel by pixel, from the reference weights.
TEST(Picture, IsTheWeightedSumOfTheSamples) {
    for (const int levels : {0, 1, 3, 5}) {
        const RecordBand band = make_band(levels, 0.5, static_cast<unsigned>(levels));
        std::map<std::pair<int, int>, std::array<double, 3>> colours;
        for (const Record& r : band.records) {
            if (r.layer != 0) continue;
            auto& c = colours[{static_cast<int>(std::lround(r.y * steps_per_px)),
                               static_cast<int>(std::lround(r.x * steps_per_px))}];
            c[0] += r.r;
            c[1] += r.g;
            c[2] += r.b;
        }
        const Places places = places_of(band);
        for (int y = band.y_begin; y + 1 < band.y_end; ++y) {
            const int columns = band.width() - 1;
            std::vector<float> row(static_cast<std::size_t>(columns) * 3);
            picture_row(band, y, band.x_begin, band.x_end - 1, row);
            for (int i = 0; i < columns; ++i) {
                Reference weights;
                add_cell(places, (band.x_begin + i) * steps_per_px, y * steps_per_px, steps_per_px, weights);
                std::array<double, 3> sum{};
                for (const auto& [place, q] : weights) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        sum[c] += (q.weight[0] + q.weight[1] + q.weight[2] + q.weight[3]) * colours[place][c];
                    }
                }
                for (std::size_t c = 0; c < 3; ++c) {
                    // The float result is the double sum rounded once: half an ulp, plus rounding in double.
                    ASSERT_NEAR(row[3 * static_cast<std::size_t>(i) + c], sum[c],
                                6.0e-8 * std::abs(sum[c]) + 1e-14);
                }
            }
        }
    }
}

TEST(Picture, IsTheSameBitsFromAnyBand) {
    const RecordBand band = make_band(3, 0.5, 5);
    std::vector<float> whole(3 * 5), narrow(3 * 5), pair(3 * 5);
    picture_row(band, 2, 0, 5, whole);
    for (std::size_t i = 0; i < 5; ++i) {
        const int x = static_cast<int>(i);
        picture_row(band, 2, x, x + 1, std::span(narrow).subspan(3 * i, 3));
    }
    picture_row(rows_of_band(band, 2, 4), 2, 0, 5, pair);
    EXPECT_EQ(whole, narrow);
    EXPECT_EQ(whole, pair);
}

TEST(Quadtree, AMissingCornerIsRefused) {
    const RecordBand good = make_band(2, 1.0, 9);
    std::size_t refused = 0;
    for (std::size_t drop = 0; drop < good.records.size(); ++drop) {
        const Record& r = good.records[drop];
        // Drops a sample of level 1 in the middle of a pixel's edge.
        if (r.layer != 0 || r.path.bits() != 0 || r.x - std::floor(r.x) != 0.5F || r.y != std::floor(r.y))
            continue;
        if (r.y + 1 >= static_cast<float>(good.y_end)) continue;
        RecordBand band = good;
        const auto is_dropped = [&](const Record& other) {
            return other.layer == 0 && other.x == r.x && other.y == r.y;
        };
        std::vector<Record> kept;
        for (std::size_t k = 0; k + 1 < good.offsets.size(); ++k) {
            for (std::uint32_t i = good.offsets[k]; i < good.offsets[k + 1]; ++i) {
                if (!is_dropped(good.records[i])) kept.push_back(good.records[i]);
            }
            band.offsets[k + 1] = static_cast<std::uint32_t>(kept.size());
        }
        band.records = kept;
        PointSamples out;
        try {
            find_point_samples(band, band.y_begin, band.y_end, band.y_begin, band.y_end - 1, out);
            ADD_FAILURE() << "accepted without " << r.x << ", " << r.y;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            EXPECT_NE(std::string(e.what()).find("lacks the sample"), std::string::npos) << e.what();
            ++refused;
        }
    }
    EXPECT_EQ(refused, 8U * 6U);
}

}  // namespace
}  // namespace postlens::test::quadtree_test
