#include "scene/texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/multiversion.h"

namespace postlens {
namespace {

// Always inlined, because functions of this file are compiled for several instruction sets. Inlined code is
// compiled with its caller's instruction set, so that std::floor and std::fma may become single instructions
// instead of function calls.
[[gnu::always_inline]] inline double exact_cell(double c, double offset, double size) {
    if (std::isinf(size)) return 0;
    const double d = c - offset;
    const double quotient = d / size;
    const double cell = std::floor(quotient);
    // Returns the index of the checkerboard cell that contains a point. `quotient`, the point's position in
    // cells, is rounded. Therefore, if the point is very close to a border, its difference from the border is
    // computed exactly (Knuth's two-sum and fma). The sign of the difference tells the cell.
    const double within = quotient - cell;
    const double near = 1e-9 * std::max(1.0, std::abs(quotient));
    if (within > near && 1 - within > near) return cell;
    const double border = std::round(quotient);
    const double part = d - c;
    const double lost = (c - (d - part)) - (offset + part);
    const double remainder = std::fma(-border, size, d);
    const bool below = remainder == 0 ? lost < 0 : remainder + lost < 0;
    return below ? border - 1 : border;
}

POSTLENS_MULTIVERSION glm::dvec3 checker_colour(const Checker& checker, const glm::dvec3& p) {
    double sum = 0;
    for (int axis = 0; axis < checker.dimensions; ++axis) {
        sum += exact_cell(p[axis], checker.offset[axis], checker.size[axis]);
    }
    return sum - 2 * std::floor(sum / 2) == 0 ? checker.even : checker.odd;
}

POSTLENS_MULTIVERSION ColourRange checker_range(const Checker& checker, const glm::dvec3& low,
                                                const glm::dvec3& high) {
    double sum = 0;
    bool border = false;
    for (int axis = 0; axis < checker.dimensions; ++axis) {
        const double size = checker.size[axis], offset = checker.offset[axis];
        const double cell = exact_cell(low[axis], offset, size);
        sum += cell;
        border = border || exact_cell(high[axis], offset, size) != cell;
    }
    ColourRange out;
    const bool even = sum - 2 * std::floor(sum / 2) == 0;
    if (even || border) out.add(checker.even);
    if (!even || border) out.add(checker.odd);
    return out;
}

glm::dvec3 texel(const ImageTexture& image, int column, int row) {
    const std::size_t at = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                static_cast<std::size_t>(column));
    return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

// Returns the fractional part of a coordinate, or 0 for NaN. Rounding can make it 1.
double tile_share(double c) {
    const double share = c - std::floor(c);
    return share >= 0 ? std::min(share, 1.0) : 0.0;
}

// Maps a coordinate to [0, 1] by repetition or by clamping.
double wrapped_or_stopped(double c, bool wraps) {
    if (wraps) return tile_share(c);
    return c >= 0 ? std::min(c, 1.0) : 0.0;
}

int wrapped(int i, int count, bool wrap) {
    if (!wrap) return std::clamp(i, 0, count - 1);
    return i < 0 ? i + count : i >= count ? i - count : i;
}

glm::dvec3 image_colour(const ImageTexture& image, const glm::dvec2& uv) {
    const bool wrap_u = !image.clamp_u, wrap_v = image.wrap_v || image.repeat.y != 1;
    const double u = wrapped_or_stopped(uv.x * image.repeat.x, wrap_u);
    const double v = wrapped_or_stopped(uv.y * image.repeat.y, wrap_v);
    const double x = u * image.width, y = (1 - v) * image.height;
    if (image.nearest) {
        return texel(image, std::min(static_cast<int>(x), image.width - 1),
                     std::min(static_cast<int>(y), image.height - 1));
    }
    // Centres of texels lie at half-integer positions.
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    const double a = x - 0.5 - left, b = y - 0.5 - top;
    const int column = static_cast<int>(left), row = static_cast<int>(top);
    const int c0 = wrapped(column, image.width, wrap_u), c1 = wrapped(column + 1, image.width, wrap_u);
    const int r0 = wrapped(row, image.height, wrap_v), r1 = wrapped(row + 1, image.height, wrap_v);
    return glm::mix(glm::mix(texel(image, c0, r0), texel(image, c1, r0), a),
                    glm::mix(texel(image, c0, r1), texel(image, c1, r1), a), b);
}

}  // namespace

double checker_cell(double c, double offset, double size) {
    return exact_cell(c, offset, size);
}

Texture::Texture(Checker checker) : checker_(checker) {
    assert(checker.dimensions == 2 || checker.dimensions == 3);
    for (int channel = 0; channel < 3; ++channel) {
        maximum_ = std::max({maximum_, checker.even[channel], checker.odd[channel]});
    }
}

Texture::Texture(ImageTexture image) : is_image_(true), image_(std::move(image)) {
    assert(image_.width > 0 && image_.height > 0);
    assert(image_.rgb.size() ==
           3 * static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(image_.height));
    for (const float value : image_.rgb) maximum_ = std::max(maximum_, static_cast<double>(value));
    ranges_ = TexelRanges(image_.rgb, image_.width, image_.height);
}

ColourRange Texture::range(const glm::dvec3& low, const glm::dvec3& high) const {
    if (!is_image_) return checker_range(checker_, low, high);
    const glm::dvec2 repeat = image_.repeat, across = repeat * glm::dvec2(high - low);
    if (!(across.x < 0.5 && across.y < 0.5)) {
        ColourRange out;
        out.add(colour_at(low));
        out.add(colour_at(high));
        return out;
    }
    // Converts the box from `low` to `high` from texture coordinates to texels, counted from the image's
    // upper left corner.
    const double x = repeat.x * low.x * image_.width, y = (1 - repeat.y * high.y) * image_.height;
    const double x_end = x + across.x * image_.width, y_end = y + across.y * image_.height;
    // With bilinear interpolation, a colour depends on the texels whose centres are less than one texel away.
    // Centres lie at half-integers, so the box is extended by half a texel on each side.
    const double reach = image_.nearest ? 0 : 0.5;
    return ranges_.of(image_.rgb, std::floor(x - reach), std::floor(x_end + reach), std::floor(y - reach),
                      std::floor(y_end + reach), !image_.clamp_u, image_.wrap_v || repeat.y != 1);
}

glm::dvec3 Texture::colour(const glm::dvec3& object, const glm::dvec2& uv) const {
    if (is_image_) return image_colour(image_, uv);
    return checker_colour(checker_, checker_.dimensions == 3 ? object : glm::dvec3(uv, 0));
}

}  // namespace postlens
