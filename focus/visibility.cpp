#include "focus/visibility.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace postlens {
namespace {

/// How independently two surfaces move over the lens, 0..1, by the signed radii of their circles, px. Below
/// about a pixel the pixel's own width decides.
double independence(double radius_px, double other_px) {
    const double larger = std::max(std::abs(radius_px), std::abs(other_px));
    return std::min(1.0, std::abs(radius_px - other_px) / (larger + 1));
}

/// A surface that has been laid down.
struct Laid {
    double radius_px;
    double alpha;  ///< as if nothing independent of it stood before it
};

// Few and nearly in order.
void sort_by_depth(std::span<Fragment> fragments) {
    for (std::size_t i = 1; i < fragments.size(); ++i) {
        const Fragment f = fragments[i];
        std::size_t k = i;
        for (; k > 0 && fragments[k - 1].inverse_depth_per_m < f.inverse_depth_per_m; --k)
            fragments[k] = fragments[k - 1];
        fragments[k] = f;
    }
}

}  // namespace

std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry) {
    constexpr double opaque = 1e-9;
    constexpr std::size_t few = 16;
    if (fragments.size() > few) {
        std::stable_sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
            return a.inverse_depth_per_m > b.inverse_depth_per_m;
        });
    } else {
        sort_by_depth(fragments);
    }
    thread_local std::vector<Laid> laid;
    laid.clear();
    std::array<double, 3> rgb{};
    double left = 1, total = 0;  // of the pixel
    for (const Fragment& f : fragments) {
        const double radius_px = geometry.coc_diameter_px(static_cast<double>(f.inverse_depth_per_m)) / 2;
        const double seen = f.seen, hidden = f.hidden;
        // What moves along with this surface and stands before it hides what the pinhole has hidden. Going
        // forward the radii part, and from some surface on all are independent.
        double along = 0;
        for (std::size_t i = laid.size(); i-- > 0 && along < 1;) {
            const double apart = independence(radius_px, laid[i].radius_px);
            if (apart >= 1) break;
            along += (1 - apart) * laid[i].alpha;
        }
        along = std::min(along, 1.0);
        const double kept_hidden = std::max(hidden - along, 0.0);
        const double alpha = seen + kept_hidden;
        const double free = along < 1 ? std::min(left / (1 - along), 1.0) : 1.0;
        double share = free;
        if (alpha * share > left) share = left / alpha;
        const double hidden_share = hidden > 0 ? share * (kept_hidden / hidden) : 0;
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c] += share * static_cast<double>(f.seen_rgb[c]) +
                      hidden_share * static_cast<double>(f.hidden_rgb[c]);
        }
        laid.push_back({radius_px, std::min(alpha, 1.0)});
        total += alpha * share;
        left -= alpha * share;
        if (left < opaque) break;
    }
    if (!(total > 0)) return {};
    for (double& channel : rgb) channel /= total;
    return rgb;
}

}  // namespace postlens
