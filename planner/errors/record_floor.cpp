#include "planner/errors/record_floor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "focus/frame.h"
#include "planner/errors/edge_cells.h"
#include "records/records_read.h"

namespace postlens {

double averaged_by(double coc_px, bool aligned) {
    return std::max(1.0, aligned ? coc_px : std::numbers::pi / 4 * coc_px * coc_px);
}

RecordFloor::RecordFloor(const SampleHeader& header, const FocusGeometry& geometry)
    : width_(header.width), height_(header.height), geometry_(geometry) {
    mse_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0F);
}

void RecordFloor::add(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves) {
    const int begin = std::max(y_begin, 0), end = std::min(y_end, height_);
    if (begin >= end) return;
    std::vector<CellCorner> corners;
    corners.reserve(leaves.points.samples.size());
    for (const PointSample& s : leaves.points.samples) corners.push_back(cell_corner(band, s));
    for (int y = begin; y < end; ++y) {
        for (int x = 0; x < width_; ++x) {
            const std::size_t k = band.pixel(x, y) - band.pixel(band.x_begin, y_begin);
            mse_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(x)] =
                pixel_error(
                    std::span(leaves.leaves)
                        .subspan(leaves.leaf_offsets[k], leaves.leaf_offsets[k + 1] - leaves.leaf_offsets[k]),
                    corners);
        }
    }
}

float RecordFloor::pixel_error(std::span<const Leaf> leaves, std::span<const CellCorner> corners) const {
    PixelEdges edges;
    SpreadLight spread;
    double coc_px = std::numeric_limits<double>::infinity();
    for (const Leaf& leaf : leaves) {
        std::array<const CellCorner*, 4> at{};
        for (std::size_t i = 0; i < 4; ++i) at[i] = &corners[leaf.corner[i]];
        const CellStep step = cell_step(at);
        edges.add(step, static_cast<double>(leaf.size));
        spread.add(at, step, static_cast<double>(leaf.size), geometry_);
        if (step.split == CellStep::Split::none) continue;
        for (const CellCorner* c : at)
            coc_px = std::min(coc_px, std::abs(geometry_.coc_diameter_px(c->inverse_z)));
    }
    double mse = edges.mse();
    if (mse > 0 && std::isfinite(coc_px)) mse /= averaged_by(coc_px, edges.aligned());
    return static_cast<float>(mse + spread.error());
}

std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry) {
    RecordFloor out(file.header(), geometry);
    FocusFrame(file).visit_rows(0, file.header().height + 1, [&](const FrameRows& rows) {
        tell({.rows = {}, .leaves = out.adds()}, *rows.band, rows.y_begin, rows.y_end);
    });
    return std::move(out).picture();
}

}  // namespace postlens
