#include "planner/record_floor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/threads.h"
#include "planner/edge_cells.h"
#include "records/quadtree.h"

namespace postlens {

double averaged_by(double coc_px, bool aligned) {
    return std::max(1.0, aligned ? coc_px : std::numbers::pi / 4 * coc_px * coc_px);
}

std::vector<float> record_floor(FocusFrame& frame, const FocusGeometry& geometry) {
    const SampleHeader& h = frame.file().header();
    std::vector<float> out(static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height), 0.0F);
    frame.visit_rows(0, h.height + 1, [&](const FrameRows& rows) {
        const int begin = std::max(rows.y_begin, 0), end = std::min(rows.y_end, h.height);
        if (begin >= end) return;
        constexpr int rows_per_task = 8;
        parallel_for(
            static_cast<std::size_t>((end - begin + rows_per_task - 1) / rows_per_task),
            [&](std::size_t task) {
                const int y0 = begin + static_cast<int>(task) * rows_per_task,
                          y1 = std::min(y0 + rows_per_task, end);
                PixelLeaves leaves;
                find_leaves(*rows.band, y0, y1, leaves);
                std::vector<CellCorner> corners;
                corners.reserve(leaves.points.samples.size());
                for (const PointSample& s : leaves.points.samples)
                    corners.push_back(cell_corner(*rows.band, s));
                for (int y = y0; y < y1; ++y) {
                    for (int x = 0; x < h.width; ++x) {
                        const std::size_t k =
                            rows.band->pixel(x, y) - rows.band->pixel(rows.band->x_begin, y0);
                        PixelEdges edges;
                        double coc_px = std::numeric_limits<double>::infinity(), bright = 0;
                        for (std::uint32_t l = leaves.leaf_offsets[k]; l < leaves.leaf_offsets[k + 1]; ++l) {
                            const Leaf& leaf = leaves.leaves[l];
                            std::array<const CellCorner*, 4> at{};
                            for (std::size_t i = 0; i < 4; ++i) at[i] = &corners[leaf.corner[i]];
                            const CellStep step = cell_step(at);
                            edges.add(step, static_cast<double>(leaf.size));
                            if (step.split == CellStep::Split::none) continue;
                            for (const CellCorner* c : at)
                                coc_px = std::min(coc_px, std::abs(geometry.coc_diameter_px(c->inverse_z)));
                            const CellCorner* brightest = *std::max_element(
                                at.begin(), at.end(), [](const CellCorner* a, const CellCorner* b) {
                                    return std::max({a->linear[0], a->linear[1], a->linear[2]}) <
                                           std::max({b->linear[0], b->linear[1], b->linear[2]});
                                });
                            bright +=
                                spread_light_error(step, static_cast<double>(leaf.size),
                                                   std::abs(geometry.coc_diameter_px(brightest->inverse_z)));
                        }
                        double mse = edges.mse();
                        if (mse > 0 && std::isfinite(coc_px)) mse /= averaged_by(coc_px, edges.aligned());
                        mse += bright;
                        out[static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width) +
                            static_cast<std::size_t>(x)] = static_cast<float>(mse);
                    }
                }
            });
    });
    return out;
}

}  // namespace postlens
