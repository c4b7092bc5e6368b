#include "planner/views/checked_pixels.h"

#include <algorithm>

#include "core/sample_hash.h"

namespace postlens {
namespace {

std::uint64_t hash_of(std::uint64_t x, std::uint64_t y, std::uint64_t purpose) {
    return mix64(mix64(mix64(x) ^ y) ^ purpose);
}

}  // namespace

CheckedPixels::CheckedPixels(int width, int height, bool random_rays) : random_rays_(random_rays) {
    // Rays measure the error of the recorded colours in at least about this many pixels. Errors of single
    // pixels vary widely, but the mean over 8000 pixels is accurate enough.
    constexpr std::int64_t enough_pixels = 8000;
    const std::int64_t pixels = std::int64_t{width} * height;
    columns_ = pixels < 16 * enough_pixels ? 2 : 4;
    rows_ = pixels < 4 * enough_pixels ? 1 : columns_;
}

CheckedPixels::Place CheckedPixels::place_of(int x, int y) const {
    const int column = x / columns_, row = y / rows_;
    const std::uint64_t h = hash_of(static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row), 1);
    return {h, static_cast<std::uint64_t>((y - row * rows_) * columns_ + x - column * columns_),
            h % pixels()};
}

CheckedPixels::Use CheckedPixels::use(int x, int y) const {
    const Place p = place_of(x, y);
    const std::uint64_t deciding = (p.stating + 1 + (p.hash >> 32U) % (pixels() - 1)) % pixels();
    return p.place == p.stating ? Use::stating : p.place == deciding ? Use::deciding : Use::none;
}

double CheckedPixels::aimed(int x, int y, int views) const {
    // Number of pixels per block in which rays measure the error of the highlights. It is proportional to
    // `views`, the number of views (images from different lens points) whose mean is the image. From
    // `all_from_views` on, all pixels are measured.
    constexpr int all_from_views = 128;
    const std::uint64_t chosen =
        std::clamp<std::uint64_t>(pixels() * static_cast<std::uint64_t>(views) / all_from_views, 1, pixels());
    const Place p = place_of(x, y);
    // Chooses `chosen` pixels of the block, and returns the fraction of chosen pixels if this pixel is one of
    // them. `rank` numbers the pixels in a scattered order, from `p.stating` on, which is always chosen. All
    // ranks differ, because `step` is coprime to the number of pixels.
    constexpr std::uint64_t step = 19;
    const std::uint64_t rank = (p.place + pixels() - p.stating) * step % pixels();
    return rank < chosen ? static_cast<double>(chosen) / static_cast<double>(pixels()) : 0;
}

void CheckedPixels::views(int x, int y, int set, int first, int count,
                          std::vector<std::uint32_t>& out) const {
    if (use(x, y) == Use::none) return;
    const std::uint64_t h =
        hash_of(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                2 + static_cast<std::uint64_t>(set) + 2 * static_cast<std::uint64_t>(first));
    const int checked = random_rays_ ? std::max(4, count / 4) : 2;
    // Consecutive lens points are well distributed over the lens.
    for (int i = 0; i < std::min(count, checked); ++i) {
        out.push_back(static_cast<std::uint32_t>((h + static_cast<std::uint64_t>(i)) %
                                                 static_cast<std::uint64_t>(count)));
    }
}

}  // namespace postlens
