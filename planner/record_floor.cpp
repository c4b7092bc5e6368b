#include "planner/record_floor.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/threads.h"
#include "records/quadtree.h"
#include "records/srgb.h"

namespace postlens {
namespace {

/// Mean square of a step of the channels that no shading makes within a pixel: a tenth.
constexpr double least_edge = 0.01;

struct Corner {
    std::array<float, 3> encoded{};
    std::uint32_t id = 0;
    double inverse_z = 0;
};

Corner corner_of(const RecordBand& band, const PointSample& s) {
    Corner out;
    std::array<float, 3> sum{};
    for (std::uint32_t k = s.first_record; k < s.first_record + s.record_count; ++k) {
        const Record& r = band.records[k];
        if (r.layer != 0) continue;
        sum[0] += r.r, sum[1] += r.g, sum[2] += r.b;
        if (r.path.bits() == 0) {
            out.id = r.id;
            out.inverse_z = std::isfinite(r.z) && r.z > 0 ? 1 / static_cast<double>(r.z) : 0;
        }
    }
    for (std::size_t c = 0; c < 3; ++c) out.encoded[c] = srgb_from_linear(sum[c]);
    return out;
}

// Expected squared error of the mean of a leaf, times its area squared.
double leaf_error(const std::array<Corner, 4>& corners, double size) {
    bool same_id = true;
    double step = 0, bend = 0;
    for (std::size_t k = 1; k < 4; ++k) same_id = same_id && corners[k].id == corners[0].id;
    for (std::size_t c = 0; c < 3; ++c) {
        double low = 1, high = 0;
        for (const Corner& corner : corners) {
            low = std::min(low, static_cast<double>(corner.encoded[c]));
            high = std::max(high, static_cast<double>(corner.encoded[c]));
        }
        step += (high - low) * (high - low) / 3;
        const double e =
            static_cast<double>(corners[0].encoded[c]) - static_cast<double>(corners[1].encoded[c]) -
            static_cast<double>(corners[2].encoded[c]) + static_cast<double>(corners[3].encoded[c]);
        bend += e * e / 3;
    }
    const double area = size * size;
    // a x^2 + b y^2 is off by (a + b) / 6; a and b are taken to be half of what the corners tell of x y.
    const bool edge = !same_id || size < 1 || step > least_edge;
    const double mse = edge ? edge_cell_variance * step : bend / 36;
    return area * area * mse;
}

}  // namespace

std::vector<float> record_floor(FocusFrame& frame, const FocusGeometry& geometry) {
    const SampleHeader& h = frame.file().header();
    std::vector<float> out(static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height), 0.0F);
    frame.visit_rows(0, h.height + 1, [&](const FrameRows& rows) {
        const int begin = std::max(rows.y_begin, 0), end = std::min(rows.y_end, h.height);
        if (begin >= end) return;
        constexpr int step = 8;
        parallel_for(static_cast<std::size_t>((end - begin + step - 1) / step), [&](std::size_t task) {
            const int y0 = begin + static_cast<int>(task) * step, y1 = std::min(y0 + step, end);
            PixelLeaves leaves;
            find_leaves(*rows.band, y0, y1, leaves);
            std::vector<Corner> corners;
            corners.reserve(leaves.points.samples.size());
            for (const PointSample& s : leaves.points.samples) corners.push_back(corner_of(*rows.band, s));
            for (int y = y0; y < y1; ++y) {
                for (int x = 0; x < h.width; ++x) {
                    const std::size_t k = rows.band->pixel(x, y) - rows.band->pixel(rows.band->x_begin, y0);
                    double mse = 0;
                    for (std::uint32_t l = leaves.leaf_offsets[k]; l < leaves.leaf_offsets[k + 1]; ++l) {
                        const Leaf& leaf = leaves.leaves[l];
                        const std::array<Corner, 4> at{corners[leaf.corner[0]], corners[leaf.corner[1]],
                                                       corners[leaf.corner[2]], corners[leaf.corner[3]]};
                        double coc_px = 1e30;
                        for (const Corner& c : at)
                            coc_px = std::min(coc_px, std::abs(geometry.coc_diameter_px(c.inverse_z)));
                        const double averaged = std::max(1.0, std::numbers::pi / 4 * coc_px * coc_px);
                        mse += leaf_error(at, static_cast<double>(leaf.size)) / averaged;
                    }
                    out[static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width) +
                        static_cast<std::size_t>(x)] = static_cast<float>(mse);
                }
            }
        });
    });
    return out;
}

}  // namespace postlens
