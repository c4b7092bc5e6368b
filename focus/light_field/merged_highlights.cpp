#include "focus/light_field/merged_highlights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "focus/responses/kernel.h"
#include "reproject/patches/patches.h"

namespace postlens {
namespace {

/// To save time, highlights (small bright areas) of one surface are merged into one light source if they lie
/// in the same square cell. This is the largest width of such cells, in px, except for points (is_point).
constexpr double largest_cell_px = 0.5;
/// Smallest width, in px, of the cells in which highlights are merged into one light source. The blur
/// kernel of a light source can only be placed at multiples of this width.
constexpr double smallest_cell_px = 1.0 / KernelKey::phase_steps;
/// Width, in px, of the cells in which sharp highlights are merged. A kernel is the mean over all parts of
/// its source (sharp_kernel), so it does not become less accurate in wide cells. But the visibility of a
/// source is found for its centre, so the cells should be small.
constexpr double sharp_cell_px = 0.25;
/// Largest error of radiance that is invisible: half an 8-bit step of a dark sRGB value, converted to
/// radiance. In the darkest part of the range, an sRGB value rises 12.92 times as fast as the radiance.
constexpr double invisible = 0.5 / 255 / 12.92;

/// Returns the width, in px, of the largest cells in which highlights can be merged without visible error.
///
/// A cell of width a has the light L a^2, with the highlight's radiance L. Merging moves this light to one
/// position: half of it to the right, for example, by a / 4 on average. The blur spreads it over A, the area
/// of blur and pixel together, in px^2. So a pixel's radiance changes by about L a^3 / (8 A), which must not
/// exceed `invisible`.
double invisible_cell_px(const Highlight& h, double blur_px) {
    const double radiance = static_cast<double>(std::max({h.rgb[0], h.rgb[1], h.rgb[2]}) / h.area),
                 area = 1 + std::numbers::pi * blur_px * blur_px,
                 wanted = std::cbrt(8 * invisible * area / radiance);
    double out = largest_cell_px;
    while (out > smallest_cell_px && out > wanted) out /= 2;
    return out;
}

double light_of(const Highlight& h) {
    return static_cast<double>(h.rgb[0]) + static_cast<double>(h.rgb[1]) + static_cast<double>(h.rgb[2]);
}

}  // namespace

std::vector<Span> divided_at_cells(double middle, double length, double cell, double first) {
    const double least = cell / 1000;  // shorter parts stay with their neighbour
    std::vector<Span> out;
    double from = middle - length / 2;
    const double end = middle + length / 2;
    for (double i = std::floor((from - first) / cell) + 1; first + i * cell < end - least; ++i) {
        const double border = first + i * cell;
        if (border - from < least) continue;
        out.push_back({(from + border) / 2, (border - from) / length});
        from = border;
    }
    out.push_back({(from + end) / 2, out.empty() ? 1 : (end - from) / length});
    return out;
}

glm::dmat2 px_from_lens(const Highlight& h, const FocusGeometry& geometry) {
    const double s = geometry.inverse_focus_per_m;
    return patch_lens(geometry).radius_px_m *
           glm::dmat2(s - static_cast<double>(h.w.xx), -static_cast<double>(h.w.yx),
                      -static_cast<double>(h.w.xy), s - static_cast<double>(h.w.yy));
}

glm::dvec2 inclination_shift_px(const Highlight& h, const FocusGeometry& geometry) {
    glm::dvec2 widening = patch_lens(geometry).radius_px_m * glm::dvec2(h.slope);
    widening /= std::max(1.0, glm::length(widening));
    return px_from_lens(h, geometry) * (widening / -4.0);
}

void MergedHighlights::add(const Highlight& h, bool is_sharp) {
    const double side = std::sqrt(static_cast<double>(h.area));
    if (!is_sharp) {
        merge(h, glm::vec2(side), {invisible_cell_px(h, patch_lens(geometry_).least_blur_px(h.w))});
        return;
    }
    // An inclined surface shifts the blur. The cells are shifted back, so that no part of a blur's centre
    // lies in two pixels.
    const glm::dvec2 first_px = -inclination_shift_px(h, geometry_);
    for (const Span& y : divided_at_cells(static_cast<double>(h.y), side, sharp_cell_px, first_px.y)) {
        for (const Span& x : divided_at_cells(static_cast<double>(h.x), side, sharp_cell_px, first_px.x)) {
            Highlight part = h;
            const auto share = static_cast<float>(x.share * y.share);
            part.x = static_cast<float>(x.middle);
            part.y = static_cast<float>(y.middle);
            part.area *= share;
            for (float& channel : part.rgb) channel *= share;
            merge(part, glm::vec2(side * x.share, side * y.share), {sharp_cell_px, first_px, true});
        }
    }
}

void MergedHighlights::add_moving(const Highlight& h, double cell_px) {
    merge(h, glm::vec2(std::sqrt(h.area)), {cell_px});
}

void MergedHighlights::merge(const Highlight& h, const glm::vec2& size, const Cells& cells) {
    const glm::ivec2 cell(glm::floor((glm::dvec2(h.x, h.y) - cells.first_px) / cells.width_px));
    const double energy = light_of(h);
    const auto per_px = static_cast<int>(std::lround(1 / cells.width_px));
    const auto [found, is_new] = merged_.try_emplace(
        {h.sheet, cells.is_sharp ? -per_px : per_px, cell.x, cell.y}, Merged{h, energy, {}, cells.is_sharp});
    auto& [sum, weight, parts, is_sharp] = found->second;
    parts.push_back(
        {{h.x, h.y}, size, (is_new ? 0 : parts.back().area_until) + h.area, static_cast<float>(energy)});
    if (is_new) return;
    const auto share = static_cast<float>(energy / (weight + energy));
    const auto mix = [share](float& to, float from) { to += share * (from - to); };
    mix(sum.x, h.x);
    mix(sum.y, h.y);
    mix(sum.inverse_z, h.inverse_z);
    mix(sum.slope.x, h.slope.x);
    mix(sum.slope.y, h.slope.y);
    mix(sum.w.xx, h.w.xx);
    mix(sum.w.xy, h.w.xy);
    mix(sum.w.yx, h.w.yx);
    mix(sum.w.yy, h.w.yy);
    for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += h.rgb[c];
    sum.area += h.area;
    weight += energy;
}

}  // namespace postlens
