#include "motionblur/groups/group_raster.h"

#include <algorithm>
#include <cmath>

#include "core/floor_div.h"
#include "core/memory.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// Tolerance for the direction of a motion path, in px. If the path deviates from the horizontal or vertical
/// direction by at most this much, it counts as horizontal or vertical.
constexpr double axis_px = 0.02;
constexpr double long_path_px = 64;  ///< length, px, from which a path along an axis needs cells of only 1 px
constexpr double short_path_px = 24;  ///< length, px, below which cells of 1/4 px are needed and affordable
constexpr double most_cells = 1 << 24;

}  // namespace

const LayerSurface* surface_of(const BandSurfaces& band, std::uint32_t sample, const GroupTable& table,
                               int g) {
    for (std::uint32_t i = band.surfaces.offsets[sample]; i < band.surfaces.offsets[sample + 1]; ++i) {
        if (table(band.surfaces.surfaces[i].id) == g) return &band.surfaces.surfaces[i];
    }
    return nullptr;
}

QuarterCells quarter_cells(const PointSample& leaf_at, float leaf_size, std::size_t corner,
                           int cells_per_px) {
    const float half = leaf_size / 2, cells = static_cast<float>(cells_per_px), edge = half * cells;
    const float x = (corner & 1) != 0 ? leaf_at.x + half : leaf_at.x,
                y = (corner & 2) != 0 ? leaf_at.y + half : leaf_at.y;
    return {static_cast<int>(std::floor(x * cells)), static_cast<int>(std::floor(y * cells)),
            edge >= 1 ? static_cast<int>(edge) : 1, edge >= 1 ? 1 : edge * edge};
}

CellWindow group_window(const std::vector<BandSurfaces>& bands, const MovingGroup& group, int c) {
    const BandSurfaces& top = bands.front();
    int rows_end = top.y_begin;
    for (const BandSurfaces& band : bands) rows_end = std::max(rows_end, band.y_end);
    const int x0 = std::max(top.x_begin, static_cast<int>(std::floor(group.extent.x_min)) - 1),
              x1 = std::min(top.x_begin + top.width - 1, static_cast<int>(std::ceil(group.extent.x_max)) + 1);
    const int y0 = std::max(top.y_begin, static_cast<int>(std::floor(group.extent.y_min)) - 1),
              y1 = std::min(std::max(rows_end, y0), static_cast<int>(std::ceil(group.extent.y_max)) + 1);
    return {x0 * c, std::max(x0, x1) * c, y0 * c, std::max(y0, y1) * c};
}

int cells_for(const MovingGroup& group) {
    glm::dvec2 low(0), high(0);
    double length = 0;
    for (std::size_t i = 0; i < group.path.size(); ++i) {
        low = glm::min(low, group.path[i].at_px);
        high = glm::max(high, group.path[i].at_px);
        if (i > 0) length += glm::length(group.path[i].at_px - group.path[i - 1].at_px);
    }
    const bool along_axis = high.x - low.x <= axis_px || high.y - low.y <= axis_px;
    const double area = (group.extent.x_max - group.extent.x_min + high.x - low.x + 2) *
                        (group.extent.y_max - group.extent.y_min + high.y - low.y + 2);
    int cells = length < short_path_px ? 4 : 2;
    if (along_axis && length >= long_path_px) cells = 1;
    while (cells > 1 && area * cells * cells > most_cells) cells /= 2;
    return cells;
}

Planes draw_group(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                  const MovingGroup& group, int cells_per_px) {
    const int c = cells_per_px;
    const CellWindow window = group_window(bands, group, c);
    Planes out{window.x_begin, window.y_begin, window.width(), window.height(), {}};
    const auto cells = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
    require_memory(cells * 4 * sizeof(float) * 3, "the raster of a moving object");
    out.planes.assign(4, std::vector<float>(cells, 0));
    const auto add_quarter = [&](const QuarterCells& q, const LayerSurface& s) {
        const float values[4] = {s.r * q.share, s.g * q.share, s.b * q.share, q.share};
        for (int j = 0; j < q.n; ++j) {
            const auto row =
                static_cast<std::size_t>(q.y - out.y_begin + j) * static_cast<std::size_t>(out.width) +
                static_cast<std::size_t>(q.x - out.x_begin);
            for (int i = 0; i < q.n; ++i) {
                for (std::size_t k = 0; k < 4; ++k)
                    out.planes[k][row + static_cast<std::size_t>(i)] += values[k];
            }
        }
    };
    parallel_for(bands.size(), [&](std::size_t b) {
        const BandSurfaces& band = bands[b];
        for_each_leaf_of(band, table, g, window, c,
                         [&](const Leaf& leaf, const std::array<const LayerSurface*, 4>& s) {
                             const PointSample& at = band.leaves.points.samples[leaf.corner[0]];
                             for (std::size_t k = 0; k < 4; ++k) {
                                 if (s[k] != nullptr) add_quarter(quarter_cells(at, leaf.size, k, c), *s[k]);
                             }
                         });
    });
    return out;
}

GroupPicture in_pixels(const Planes& cells, int c, int width, int height) {
    GroupPicture out;
    out.x_begin = std::clamp(floor_div(cells.x_begin, c), 0, width);
    out.y_begin = std::clamp(floor_div(cells.y_begin, c), 0, height);
    out.x_end = std::clamp(floor_div(cells.x_begin + cells.width + c - 1, c), out.x_begin, width);
    out.y_end = std::clamp(floor_div(cells.y_begin + cells.height + c - 1, c), out.y_begin, height);
    const auto columns = static_cast<std::size_t>(out.x_end - out.x_begin);
    out.rgba.assign(columns * static_cast<std::size_t>(out.y_end - out.y_begin), {0, 0, 0, 0});
    const float share = 1.0F / static_cast<float>(c * c);
    parallel_for(
        static_cast<std::size_t>(out.y_end - out.y_begin),
        [&](std::size_t row) {
            const int y = out.y_begin + static_cast<int>(row);
            for (int x = out.x_begin; x < out.x_end; ++x) {
                auto& to = out.rgba[row * columns + static_cast<std::size_t>(x - out.x_begin)];
                for (int j = std::max(y * c, cells.y_begin);
                     j < std::min((y + 1) * c, cells.y_begin + cells.height); ++j) {
                    for (int i = std::max(x * c, cells.x_begin);
                         i < std::min((x + 1) * c, cells.x_begin + cells.width); ++i) {
                        const auto k = static_cast<std::size_t>(j - cells.y_begin) *
                                           static_cast<std::size_t>(cells.width) +
                                       static_cast<std::size_t>(i - cells.x_begin);
                        for (std::size_t p = 0; p < 4; ++p) to[p] += share * cells.planes[p][k];
                    }
                }
            }
        },
        16);
    return out;
}

}  // namespace postlens
