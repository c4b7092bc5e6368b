// Divides an image into tiles, squares of 64 px. Each tile has its own number of views (images from different
// lens points). Tiles are divided into smaller squares, the pieces. Each piece has its own lens points.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace postlens {

struct TileGrid {
    static constexpr int edge = 64;  ///< px
    int width = 0, height = 0;       ///< of the image, px

    [[nodiscard]] int columns() const { return (width + edge - 1) / edge; }
    [[nodiscard]] int rows() const { return (height + edge - 1) / edge; }
    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(columns()) * static_cast<std::size_t>(rows());
    }
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y / edge) * static_cast<std::size_t>(columns()) +
               static_cast<std::size_t>(x / edge);
    }
    [[nodiscard]] int pixels(std::size_t tile) const {
        const int x = static_cast<int>(tile) % columns() * edge,
                  y = static_cast<int>(tile) / columns() * edge;
        return std::min(edge, width - x) * std::min(edge, height - y);
    }
    /// Returns, for each tile, the mean of the values of its pixels. `values` has one value per pixel of the
    /// image, row by row.
    [[nodiscard]] std::vector<double> means(std::span<const float> values) const {
        std::vector<double> out(count(), 0);
        auto value = values.begin();
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) out[at(x, y)] += static_cast<double>(*value++);
        }
        for (std::size_t t = 0; t < out.size(); ++t) out[t] /= pixels(t);
        return out;
    }
};

/// Returns the width, in px, of a piece of the image: a square with its own lens points, and therefore
/// independent noise. Small images have smaller pieces, but of at least 4 px, because an accurate estimate of
/// the noise needs 2000 pieces.
[[nodiscard]] inline int piece_px(int width, int height) {
    constexpr int least_pieces = 2000, smallest_px = 4;
    int px = TileGrid::edge;
    while (px > smallest_px && (width + px - 1) / px * ((height + px - 1) / px) < least_pieces) px /= 2;
    return px;
}

}  // namespace postlens
