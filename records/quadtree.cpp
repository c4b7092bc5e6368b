#include "records/quadtree.h"

#include <algorithm>
#include <cassert>

#include "core/error.h"
#include "records/record_check.h"

namespace postlens {
namespace {

/// Number of steps in the width of a pixel. A step is the unit of positions in this file: all samples lie at
/// multiples of it, so their positions are exact integers. A pixel is divided into quadtree cells, and no
/// cell is narrower than one step.
constexpr int pixel_steps = position_steps;

/// Position within a pixel: u steps to the right of its upper left corner, and v steps below this corner. The
/// pixel is pixel_steps wide.
struct Place {
    int u = 0, v = 0;
};

/// Calls leaf(position, size) for each leaf (undivided cell) of the quadtree cell that begins at `at` and is
/// `size` steps wide. The order of its quarters is up-left, up-right, down-left, down-right.
template <typename HasSample, typename Leaf>
void for_each_leaf(Place at, int size, const HasSample& has_sample, const Leaf& leaf) {
    const int half = size / 2;
    // A cell is divided if it has a sample at its centre.
    if (half == 0 || !has_sample(Place{at.u + half, at.v + half})) {
        leaf(at, size);
        return;
    }
    for_each_leaf(at, half, has_sample, leaf);
    for_each_leaf(Place{at.u + half, at.v}, half, has_sample, leaf);
    for_each_leaf(Place{at.u, at.v + half}, half, has_sample, leaf);
    for_each_leaf(Place{at.u + half, at.v + half}, half, has_sample, leaf);
}

[[noreturn]] void fail_missing(int x, int y, Place at) {
    fail(ExitCode::invalid_input, "records: quadtree of pixel ({}, {}) lacks the sample at ({}, {})", x, y,
         x + at.u / static_cast<double>(pixel_steps), y + at.v / static_cast<double>(pixel_steps));
}

/// Calls on_sample(first_record, count) for each point sample (eye ray) of pixel (x, y) that the pinhole
/// sees, sorted by y, then by x. With `top_edge_only`, only samples on the pixel's upper edge are passed.
/// Throws if the pixel has no sample at its upper left corner.
template <typename OnSample>
void for_each_sample(const RecordBand& band, int x, int y, bool top_edge_only, const OnSample& on_sample) {
    const std::size_t k = band.pixel(x, y);
    const std::uint32_t begin = band.offsets[k], end = band.offsets[k + 1];
    const Record* records = band.records.data();
    const auto visible = [&](std::uint32_t i) { return i < end && records[i].layer == 0; };
    const auto top = static_cast<float>(y);
    if (!visible(begin) || records[begin].x != static_cast<float>(x) || records[begin].y != top) {
        fail_missing(x, y, {});
    }
    for (std::uint32_t first = begin; visible(first) && !(top_edge_only && records[first].y != top);) {
        std::uint32_t next = first + 1;
        while (visible(next) && records[next].x == records[first].x && records[next].y == records[first].y)
            ++next;
        on_sample(first, next - first);
        first = next;
    }
}

/// The point samples of one row of pixels. Pixel x has the samples offsets[x - x_begin] to offsets[x -
/// x_begin + 1] - 1.
template <typename Sample>
struct Row {
    Sample* samples = nullptr;
    const std::uint32_t* offsets = nullptr;
};

template <typename Sample>
Sample* find_in_pixel(const Row<Sample>& row, std::size_t column, float x, float y) {
    Sample* begin = row.samples + row.offsets[column];
    Sample* end = row.samples + row.offsets[column + 1];
    Sample* found = std::lower_bound(
        begin, end, y, [x](const auto& s, float key_y) { return s.y != key_y ? s.y < key_y : s.x < x; });
    return found != end && found->x == x && found->y == y ? found : nullptr;
}

/// A table of a pixel's samples by their position. A look-up is much faster than a search in the list of
/// samples.
template <typename Sample>
class PlacedSamples {
  public:
    /// Fills the table `at_`, in which a sample of pixel (x, y) can be found by its position. The table has a
    /// fixed grid of positions. Returns false if a sample of the pixel lies between these positions, because
    /// the pixel's quadtree is too fine.
    /// - `above`, `below`: the stored samples of the rows y and y + 1. The samples on the pixel's lower edge
    ///   are stored in row y + 1, and those on its right edge with the next pixel.
    /// - `column`: index of the pixel in its row
    bool place(const Row<Sample>& above, const Row<Sample>& below, int x, int y, std::size_t column) {
        for (const std::size_t k : used_) at_[k] = nullptr;
        used_.clear();
        const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
        for (Sample* s = first(above, column); s != first(above, column + 1); ++s) {
            if (!add(*s, fx, fy)) return false;
        }
        // Adds the samples on this pixel's right edge to the table `at_`. They are stored with the pixel on
        // the right. If its quadtree is finer, some of them are no corners of this pixel's cells, and add()
        // skips them.
        for (Sample* s = first(above, column + 1); s != first(above, column + 2); ++s) {
            if (s->x == fx + 1) add(*s, fx, fy);
        }
        for (Sample* s = first(below, column); s != first(below, column + 1) && s->y == fy + 1; ++s)
            add(*s, fx, fy);
        if (first(below, column + 1) != first(below, column + 2)) add(*first(below, column + 1), fx, fy);
        return true;
    }
    [[nodiscard]] Sample* at(Place p) const {
        if ((p.u | p.v) % step != 0) return nullptr;
        return at_[index(p.v / step, p.u / step)];
    }

  private:
    /// Size of the table `at_`, which contains a pixel's samples by position. It has 64 steps, and therefore
    /// 65 positions, along each edge of the pixel. These suffice for six levels of quadtree subdivision. A
    /// larger table would not fit into the processor's cache.
    static constexpr int edge = 64, places = edge + 1, step = pixel_steps / edge;
    static Sample* first(const Row<Sample>& row, std::size_t column) {
        return row.samples + row.offsets[column];
    }
    static std::size_t index(int row, int column) {
        return static_cast<std::size_t>(row) * places + static_cast<std::size_t>(column);
    }
    bool add(Sample& s, float x, float y) {
        const float u = (s.x - x) * edge, v = (s.y - y) * edge;
        if (!(u >= 0 && u <= edge && v >= 0 && v <= edge)) return false;
        const int column = static_cast<int>(u), row = static_cast<int>(v);
        if (static_cast<float>(column) != u || static_cast<float>(row) != v) return false;
        used_.push_back(index(row, column));
        at_[used_.back()] = &s;
        return true;
    }

    std::vector<Sample*> at_ = std::vector<Sample*>(static_cast<std::size_t>(places) * places, nullptr);
    std::vector<std::size_t> used_;
};

/// Calls on_leaf(corners, size_px) for each quadtree leaf (undivided cell) of pixel (x, y). The corners are
/// up-left, up-right, down-left, down-right. `above` contains the samples of row y, and `below` those of the
/// next row.
template <typename Sample, typename OnLeaf>
void for_each_leaf_of_pixel(const Row<Sample>& above, const Row<Sample>& below, int x, int y,
                            std::size_t column, const OnLeaf& on_leaf) {
    if (above.offsets[column + 1] - above.offsets[column] == 1) {
        on_leaf(std::array<Sample*, 4>{above.samples + above.offsets[column],
                                       above.samples + above.offsets[column + 1],
                                       below.samples + below.offsets[column],
                                       below.samples + below.offsets[column + 1]},
                1.0F);
        return;
    }
    const auto visit = [&](const auto& find) {
        const auto need = [&](Place at) {
            Sample* s = find(at);
            if (s == nullptr) fail_missing(x, y, at);
            return s;
        };
        for_each_leaf(
            Place{}, pixel_steps, [&](Place at) { return find(at) != nullptr; },
            [&](Place at, int size) {
                on_leaf(std::array<Sample*, 4>{need(at), need({at.u + size, at.v}), need({at.u, at.v + size}),
                                               need({at.u + size, at.v + size})},
                        static_cast<float>(size) / pixel_steps);
            });
    };
    thread_local PlacedSamples<Sample> placed;
    if (placed.place(above, below, x, y, column)) {
        visit([&](Place at) { return placed.at(at); });
    } else {
        visit([&](Place at) {
            const float sample_x = static_cast<float>(x) + static_cast<float>(at.u) / pixel_steps;
            const float sample_y = static_cast<float>(y) + static_cast<float>(at.v) / pixel_steps;
            return find_in_pixel(at.v == pixel_steps ? below : above,
                                 column + (at.u == pixel_steps ? 1U : 0U), sample_x, sample_y);
        });
    }
}

void append_row(const RecordBand& band, int y, PointSamples& out) {
    const Record* records = band.records.data();
    for (int x = band.x_begin; x < band.x_end; ++x) {
        for_each_sample(band, x, y, false, [&](std::uint32_t first, std::uint32_t count) {
            out.samples.push_back({records[first].x, records[first].y, first, count, {}, {}});
        });
        out.offsets.push_back(static_cast<std::uint32_t>(out.samples.size()));
    }
}

/// Position and colour of a point sample.
struct ColourSample {
    float x, y;
    double r, g, b;
};

struct ColourRow {
    std::vector<ColourSample> samples;
    std::vector<std::uint32_t> offsets{0};
    [[nodiscard]] Row<const ColourSample> view() const { return {samples.data(), offsets.data()}; }
};

/// Sets `row` to the samples of the pixels x_begin to x_end - 1 in pixel row y, with their colours. With
/// `top_edge_only`, includes only the samples on the upper edge of these pixels. These samples suffice for
/// the pixel row y - 1, whose lower edge this is.
void colours_of_row(const RecordBand& band, int y, int x_begin, int x_end, bool top_edge_only,
                    ColourRow& row) {
    row.samples.clear();
    row.offsets.assign(1, 0);
    for (int x = x_begin; x < x_end; ++x) {
        for_each_sample(band, x, y, top_edge_only, [&](std::uint32_t first, std::uint32_t count) {
            const Record* r = band.records.data() + first;
            ColourSample s{r->x, r->y, 0, 0, 0};
            for (const Record* end = r + count; r != end; ++r) {
                s.r += r->r;
                s.g += r->g;
                s.b += r->b;
            }
            row.samples.push_back(s);
        });
        row.offsets.push_back(static_cast<std::uint32_t>(row.samples.size()));
    }
}

}  // namespace

void find_point_samples(const RecordBand& band, int y_begin, int y_end, int pixel_y_begin, int pixel_y_end,
                        PointSamples& out) {
    assert(y_begin >= band.y_begin && y_end <= band.y_end && y_begin < y_end);
    out.samples.clear();
    out.offsets.assign(1, 0);
    out.samples.reserve(static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(band.width()));
    for (int y = y_begin; y < y_end; ++y) append_row(band, y, out);

    const int first_pixel_row = std::max(pixel_y_begin, y_begin - 1);
    const int last_pixel_row = std::min(pixel_y_end, y_end) - 1;
    if (first_pixel_row > last_pixel_row) return;

    // Reads the rows of samples above and below the requested rows. The weights of the requested samples
    // depend on all quadtree cells around them, and some of these cells have their other corners in the rows
    // `above` and `below`.
    PointSamples above, below;
    above.offsets.assign(1, 0);
    below.offsets.assign(1, 0);
    if (first_pixel_row < y_begin) append_row(band, y_begin - 1, above);
    if (last_pixel_row + 1 == y_end) append_row(band, y_end, below);

    const auto width = static_cast<std::size_t>(band.width());
    const auto row_at = [&](int y) -> Row<PointSample> {
        if (y < y_begin) return {above.samples.data(), above.offsets.data()};
        if (y >= y_end) return {below.samples.data(), below.offsets.data()};
        return {out.samples.data(), out.offsets.data() + static_cast<std::size_t>(y - y_begin) * width};
    };
    for (int y = first_pixel_row; y <= last_pixel_row; ++y) {
        const Row<PointSample> upper = row_at(y);
        const Row<PointSample> lower = row_at(y + 1);
        for (std::size_t column = 0; column + 1 < width; ++column) {
            for_each_leaf_of_pixel(upper, lower, band.x_begin + static_cast<int>(column), y, column,
                                   [](const std::array<PointSample*, 4>& corners, float size) {
                                       // Each sample at a corner c of this cell gets a weight of a quarter of
                                       // the cell's area. Corners and the cells around a sample are numbered
                                       // alike: 0 up-left, 1 up-right, 2 down-left, 3 down-right. Seen from
                                       // corner c, this cell is number 3 - c.
                                       for (std::size_t c = 0; c < 4; ++c) {
                                           corners[c]->weight[3 - c] = size * size / 4;
                                           corners[c]->leaf_size[3 - c] = size;
                                       }
                                   });
        }
    }
}

void find_leaves(const RecordBand& band, int y_begin, int y_end, PixelLeaves& out) {
    assert(y_begin >= band.y_begin && y_end < band.y_end && y_begin < y_end);
    PointSamples& points = out.points;
    points.samples.clear();
    points.offsets.assign(1, 0);
    out.leaves.clear();
    out.leaf_offsets.assign(1, 0);
    for (int y = y_begin; y <= y_end; ++y) append_row(band, y, points);
    const auto width = static_cast<std::size_t>(band.width());
    const auto row_at = [&](int y) -> Row<PointSample> {
        return {points.samples.data(), points.offsets.data() + static_cast<std::size_t>(y - y_begin) * width};
    };
    const PointSample* first = points.samples.data();
    for (int y = y_begin; y < y_end; ++y) {
        const Row<PointSample> upper = row_at(y), lower = row_at(y + 1);
        for (std::size_t column = 0; column < width; ++column) {
            if (column + 1 < width) {
                for_each_leaf_of_pixel(upper, lower, band.x_begin + static_cast<int>(column), y, column,
                                       [&](const std::array<PointSample*, 4>& corners, float size) {
                                           Leaf leaf{{}, size};
                                           for (std::size_t c = 0; c < 4; ++c)
                                               leaf.corner[c] =
                                                   static_cast<std::uint32_t>(corners[c] - first);
                                           out.leaves.push_back(leaf);
                                       });
            }
            out.leaf_offsets.push_back(static_cast<std::uint32_t>(out.leaves.size()));
        }
    }
}

void picture_row(const RecordBand& band, int y, int x_begin, int x_end, std::span<float> rgb) {
    assert(y >= band.y_begin && y + 1 < band.y_end && x_begin >= band.x_begin && x_end < band.x_end);
    assert(rgb.size() == static_cast<std::size_t>(x_end - x_begin) * 3);
    thread_local ColourRow upper, lower;
    colours_of_row(band, y, x_begin, x_end + 1, false, upper);
    colours_of_row(band, y + 1, x_begin, x_end + 1, true, lower);
    for (int x = x_begin; x < x_end; ++x) {
        const auto column = static_cast<std::size_t>(x - x_begin);
        double r = 0, g = 0, b = 0;
        for_each_leaf_of_pixel(upper.view(), lower.view(), x, y, column,
                               [&](const std::array<const ColourSample*, 4>& c, float size) {
                                   const double weight =
                                       static_cast<double>(size) * static_cast<double>(size) / 4;
                                   r += weight * (c[0]->r + c[1]->r + c[2]->r + c[3]->r);
                                   g += weight * (c[0]->g + c[1]->g + c[2]->g + c[3]->g);
                                   b += weight * (c[0]->b + c[1]->b + c[2]->b + c[3]->b);
                               });
        rgb[3 * column] = static_cast<float>(r);
        rgb[3 * column + 1] = static_cast<float>(g);
        rgb[3 * column + 2] = static_cast<float>(b);
    }
}

}  // namespace postlens
