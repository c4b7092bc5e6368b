#include "focus/light_field/bright_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace postlens {
namespace {

/// A pixel gets one additional ray per view for each such step of the surface's radiance, but at most
/// most_rays.
constexpr double radiance_per_ray = 4;
constexpr int most_rays = 16;
/// Surfaces with a larger blur radius, in px, get no additional rays. Their light is spread over many pixels,
/// so that it causes less noise in each.
constexpr double widest_blur_px = 4;
/// Largest mean number of additional rays per view, over all pixels of the sample file.
constexpr double most_per_pixel = 0.25;
/// A pixel counts as filled if bright surfaces cover more than this part of it.
constexpr float filled_px2 = 0.99F;

}  // namespace

BrightEdges::BrightEdges(const RasterWindow& recorded)
    : recorded_(recorded),
      rays_(static_cast<std::size_t>(std::max(recorded.width(), 0)) *
            static_cast<std::size_t>(std::max(recorded.height(), 0))) {}

void BrightEdges::add(const TreeSheets& sheets, const HighlightRule& rule, const PatchLens& lens) {
    add(sheets.primary, rule, lens);
    add(sheets.deeper, rule, lens);
}

void BrightEdges::add(const SheetMesh& mesh, const HighlightRule& rule, const PatchLens& lens) {
    struct Bright {
        int x, y, rays, reach_px;
    };
    std::vector<Bright> found;
    std::vector<float> covered;  // per pixel, px^2
    const std::vector<BrightSheet> sheets = bright_sheets(mesh);
    for (const Highlight& light : mesh.bright) {
        const SheetKey& key = mesh.sheets[light.sheet].key;
        const double blur_px = lens.least_blur_px(light.w),
                     radiance = static_cast<double>(std::max({light.rgb[0], light.rgb[1], light.rgb[2]}) /
                                                    light.area);
        if (!(radiance >= radiance_per_ray) || !(blur_px <= widest_blur_px)) continue;
        const Bright here{static_cast<int>(std::floor(light.x)), static_cast<int>(std::floor(light.y)),
                          static_cast<int>(std::min<double>(most_rays, radiance / radiance_per_ray)),
                          static_cast<int>(std::ceil(blur_px + 0.5))};
        const bool is_recorded = here.x >= recorded_.x_begin && here.x < recorded_.x_end &&
                                 here.y >= recorded_.y_begin && here.y < recorded_.y_end;
        if (!is_recorded || rule.takes(light, key, sheets[light.sheet])) continue;
        covered.resize(rays_.size());
        if (!key.hidden) covered[index(here.x, here.y)] += light.area;
        found.push_back(here);
    }
    const auto is_filled = [&](int x, int y) {
        const bool inside =
            x >= recorded_.x_begin && x < recorded_.x_end && y >= recorded_.y_begin && y < recorded_.y_end;
        return inside && covered[index(x, y)] > filled_px2;
    };
    for (const Bright& b : found) {
        if (is_filled(b.x, b.y) && is_filled(b.x - 1, b.y) && is_filled(b.x + 1, b.y) &&
            is_filled(b.x, b.y - 1) && is_filled(b.x, b.y + 1))
            continue;
        const RasterWindow near = common(
            recorded_, {b.x - b.reach_px, b.x + b.reach_px + 1, b.y - b.reach_px, b.y + b.reach_px + 1});
        for (int y = near.y_begin; y < near.y_end; ++y) {
            for (int x = near.x_begin; x < near.x_end; ++x) {
                std::uint8_t& rays = rays_[index(x, y)];
                rays = std::max(rays, static_cast<std::uint8_t>(b.rays));
            }
        }
    }
}

int BrightEdges::most_in(const RasterWindow& window) const {
    const RasterWindow in = common(window, recorded_);
    int most = 0;
    for (int y = in.y_begin; y < in.y_end; ++y) {
        for (int x = in.x_begin; x < in.x_end; ++x) most = std::max<int>(most, rays_[index(x, y)]);
    }
    return most;
}

void BrightEdges::limit() {
    std::array<double, most_rays + 1> at_least{};  // number of pixels with that many rays or more
    for (const std::uint8_t rays : rays_) {
        for (std::size_t n = 1; n <= rays; ++n) ++at_least[n];
    }
    double left = most_per_pixel * static_cast<double>(rays_.size());
    std::uint8_t cap = 0;
    while (cap < most_rays && at_least[static_cast<std::size_t>(cap) + 1] <= left) left -= at_least[++cap];
    for (std::uint8_t& rays : rays_) rays = std::min(rays, cap);
    for (const std::uint8_t rays : rays_) most_ = std::max<int>(most_, rays);
}

}  // namespace postlens
