// Positions and samples of the quadtree cells into which pixels are divided. A grid contains all positions at
// which a cell may have a corner. Where a corner exists, an eye ray is traced through it, and the result is
// its sample.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "tracer/recording/corner_sampler.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// Position of a corner of a quadtree cell, relative to the upper left corner of the traced window.
/// The unit is the width of the smallest cell, 2^-levels px.
using CornerKey = std::uint64_t;  // y << 32 | x

struct CornerGrid {
    CornerGrid(const SampledWindow& of, int subdivision_levels)
        : window(of),
          levels(subdivision_levels),
          unit(1U << subdivision_levels),
          columns(of.x_end - of.x_begin + 1) {}

    SampledWindow window;
    int levels;          ///< SubdivisionSettings::levels
    std::uint32_t unit;  ///< grid units per px
    int columns;         ///< pixel corners per row

    [[nodiscard]] static CornerKey key(std::uint32_t x, std::uint32_t y) {
        return (static_cast<CornerKey>(y) << 32) | x;
    }
    /// Returns the y coordinate, in grid units, of the upper edge of pixel row `y`. It is measured from the
    /// upper edge of the traced window. A grid unit is the width of the smallest quadtree cell.
    [[nodiscard]] std::uint32_t row(int y) const {
        return static_cast<std::uint32_t>(y - window.y_begin) * unit;
    }
    [[nodiscard]] std::uint32_t to_pixels(std::uint32_t grid) const { return grid >> levels; }
    /// Raster position, px.
    [[nodiscard]] glm::dvec2 position(CornerKey k) const {
        return {window.x_begin + static_cast<double>(static_cast<std::uint32_t>(k)) / unit,
                window.y_begin + static_cast<double>(k >> 32) / unit};
    }
};

/// The result of one eye ray, through a corner of one or more quadtree cells. The object that it hits first,
/// given by its id and connected part, and the depth and colour decide whether these cells are divided. All
/// its surface hits are stored as records in a list of buffers: in buffer number `chunk`, `count` records
/// from the index `first` on.
struct CornerSample {
    std::uint32_t x = 0, y = 0;  ///< grid units
    std::uint32_t chunk = 0, first = 0, count = 0;
    std::uint32_t visible = 0;  ///< number of records of layer 0, which come first
    std::uint32_t id = 0;       ///< id of the primary node
    std::uint32_t part = 0;     ///< ColourSource::part of the primary node
    float z = 0;                ///< z' of the primary node, m
    float r = 0, g = 0, b = 0;
};

/// A quadtree cell: a pixel or a part of one. It can be divided into quarters.
struct CornerCell {
    std::uint32_t x, y;  ///< grid units, upper left
    std::uint32_t size;  ///< grid units; a cell of size 1 cannot be divided
    std::array<std::uint32_t, 4>
        corner;  ///< sample indices: upper left, upper right, lower left, lower right
    /// Indices of the five samples that are traced to divide the cell: at the middle of its upper side and of
    /// its left side, at its centre, and at the middle of its right side and of its lower side. They are not
    /// set if the cell is undivided.
    std::array<std::uint32_t, 5> between;
};

/// Quadtree cells are divided if the radiance at their corners differs, and noise would divide every cell. So
/// this function returns a hit's radiance without the part that has sampling noise.
[[nodiscard]] inline glm::vec3 steady_radiance(const TracedSamples& chunk, std::size_t record) {
    const Record& r = chunk.records[record];
    const glm::vec3 all(r.r, r.g, r.b);
    return chunk.noisy.empty() ? all : all - chunk.noisy[record];
}

}  // namespace postlens
