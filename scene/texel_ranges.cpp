#include "scene/texel_ranges.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

constexpr int first_square = 4;  ///< texels
/// Largest width and height, in squares, of an area whose range of colours is combined from the ranges of
/// squares. The squares are single texels, or have 4, 8, 16, ... texels per side and precomputed ranges. The
/// smallest size with which the area does not exceed this limit is used.
constexpr double most_across = 9;

int place(double at, int count, bool wrap) {
    if (wrap) at -= std::floor(at / count) * count;
    return static_cast<int>(std::clamp(at, 0.0, count - 1.0));
}

void widen(std::array<float, 6>& range, const float* low, const float* high) {
    for (std::size_t c = 0; c < 3; ++c) {
        range[c] = std::min(range[c], low[c]);
        range[c + 3] = std::max(range[c + 3], high[c]);
    }
}

constexpr std::array<float, 6> nothing{HUGE_VALF, HUGE_VALF, HUGE_VALF, -HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

}  // namespace

TexelRanges::TexelRanges(std::span<const float> rgb, int width, int height) : width_(width), height_(height) {
    int below_width = width, below_height = height, step = first_square;
    while (below_width > 1 || below_height > 1) {
        Level level;
        level.width = (below_width + step - 1) / step;
        level.height = (below_height + step - 1) / step;
        level.squares.assign(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height),
                             nothing);
        const Level* below = levels_.empty() ? nullptr : &levels_.back();
        for (int y = 0; y < below_height; ++y) {
            for (int x = 0; x < below_width; ++x) {
                const auto from = static_cast<std::size_t>(y) * static_cast<std::size_t>(below_width) +
                                  static_cast<std::size_t>(x);
                auto& to =
                    level.squares[static_cast<std::size_t>(y / step) * static_cast<std::size_t>(level.width) +
                                  static_cast<std::size_t>(x / step)];
                if (below != nullptr) {
                    const auto& square = below->squares[from];
                    widen(to, square.data(), square.data() + 3);
                } else {
                    widen(to, rgb.data() + 3 * from, rgb.data() + 3 * from);
                }
            }
        }
        below_width = level.width;
        below_height = level.height;
        step = 2;
        levels_.push_back(std::move(level));
    }
}

ColourRange TexelRanges::of(std::span<const float> rgb, double x_first, double x_last, double y_first,
                            double y_last, bool wrap_x, bool wrap_y) const {
    std::array<float, 6> range = nothing;
    // Colour ranges are precomputed on several levels. Level 0 consists of the texels themselves, and each
    // higher level of larger squares. This loop finds the lowest level on which the longer edge of the given
    // rectangle is at most `most_across` squares (or texels) long.
    const double across = std::max(x_last - x_first, y_last - y_first) + 1;
    std::size_t level = 0;
    double edge = 1;
    while (level < levels_.size() && across / edge > most_across) {
        edge = level == 0 ? first_square : 2 * edge;
        ++level;
    }
    const int width = level == 0 ? width_ : levels_[level - 1].width,
              height = level == 0 ? height_ : levels_[level - 1].height;
    // These functions return the column and the row of the square of texels that contains a position, in
    // texels. In a repeated image, the position must be moved into the image first, and not the square's
    // index, because the last squares may contain fewer texels.
    const auto column = [&](double x) { return static_cast<int>(place(x, width_, wrap_x) / edge); };
    const auto row = [&](double y) { return static_cast<int>(place(y, height_, wrap_y) / edge); };
    const auto squares = [](int first, int last, int count, bool wraps) {
        return wraps && last < first ? last - first + count + 1 : last - first + 1;
    };
    const bool all_columns = x_last - x_first + 1 >= width_, all_rows = y_last - y_first + 1 >= height_;
    const int x0 = all_columns ? 0 : column(x_first), y0 = all_rows ? 0 : row(y_first);
    const int columns = all_columns ? width : std::min(squares(x0, column(x_last), width, wrap_x), width),
              rows = all_rows ? height : std::min(squares(y0, row(y_last), height, wrap_y), height);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto k = static_cast<std::size_t>((y0 + j) % height) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>((x0 + i) % width);
            if (level == 0) {
                widen(range, rgb.data() + 3 * k, rgb.data() + 3 * k);
            } else {
                const auto& square = levels_[level - 1].squares[k];
                widen(range, square.data(), square.data() + 3);
            }
        }
    }
    return {{range[0], range[1], range[2]}, {range[3], range[4], range[5]}};
}

}  // namespace postlens
