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

void sort_by_depth(std::span<Fragment> fragments) {
    constexpr std::size_t few = 16;
    if (fragments.size() > few) {
        std::stable_sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
            return a.inverse_depth_per_m > b.inverse_depth_per_m;
        });
        return;
    }
    for (std::size_t i = 1; i < fragments.size(); ++i) {
        const Fragment f = fragments[i];
        std::size_t k = i;
        for (; k > 0 && fragments[k - 1].inverse_depth_per_m < f.inverse_depth_per_m; --k)
            fragments[k] = fragments[k - 1];
        fragments[k] = f;
    }
}

}  // namespace

namespace {

/// What of the lens is still free at a pixel: T(q) = mean + 4 tilt . q.
struct FreeLens {
    double mean = 1;
    LensMoment tilt;

    /// Share of something that passes, by its sum and its moment, 0 to 1.
    [[nodiscard]] double passing(double sum, const LensMoment& moment, double along) const {
        if (sum == 0) return 0;
        const double t = mean + 4 * (tilt.x * moment.x + tilt.y * moment.y) / sum;
        // What moves along with it has been taken from the surface itself, not from the lens.
        return along < 1 ? std::clamp(t / (1 - along), 0.0, 1.0) : 1;
    }
    void cover(double laid, double alpha, const LensMoment& moment, double along) {
        // Of what is independent the product of two linear functions, without its quadratic part.
        const auto left = [&](double t, double m) {
            return t - (along * m + (1 - along) * (mean * m + alpha * t));
        };
        tilt = {left(tilt.x, moment.x), left(tilt.y, moment.y)};
        mean -= laid;
        // No part of the disc has a greater moment: a half of it 0.21, a small part at the rim its own size.
        const double most = std::max(mean * (1 - mean), 0.0), is = std::hypot(tilt.x, tilt.y);
        if (is > most) tilt = {tilt.x * (most / is), tilt.y * (most / is)};
    }
};

/// What of a surface is not known to be hidden by what moves along with it.
SurfaceLight kept_light(const Fragment& f, double along) {
    SurfaceLight out = f.seen;
    if (!(f.hidden.alpha > along)) return out;
    const double kept = 1 - along / f.hidden.alpha;
    out.alpha += kept * f.hidden.alpha;
    for (std::size_t c = 0; c < 3; ++c) out.rgb[c] += kept * f.hidden.rgb[c];
    for (std::size_t c = 0; c < 4; ++c) {
        out.lens[c].x += kept * f.hidden.lens[c].x;
        out.lens[c].y += kept * f.hidden.lens[c].y;
    }
    return out;
}

/// How much of what has been laid down moves along with a surface. Going forward the radii part, and from some
/// surface on all are independent.
double moving_along(std::span<const Laid> laid, double radius_px) {
    double along = 0;
    for (std::size_t i = laid.size(); i-- > 0 && along < 1;) {
        const double apart = independence(radius_px, laid[i].radius_px);
        if (apart >= 1) break;
        along += (1 - apart) * laid[i].alpha;
    }
    return std::min(along, 1.0);
}

/// Which of two surfaces that pass through each other is the nearer one, their mean depths in a pixel do not say:
/// what is seen of those that come next, within half a pixel of radius, may be before this one as well.
double as_near(std::span<const Fragment> behind, double radius_px, const FocusGeometry& geometry) {
    double near = 0;
    for (const Fragment& f : behind) {
        const double apart_px = std::abs(radius_px - geometry.coc_diameter_px(f.inverse_depth_per_m) / 2);
        if (apart_px >= 0.5) break;
        near += (1 - 2 * apart_px) * f.seen.alpha;
    }
    return near;
}

}  // namespace

std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry) {
    constexpr double opaque = 1e-9;
    sort_by_depth(fragments);
    thread_local std::vector<Laid> laid;
    laid.clear();
    std::array<double, 3> rgb{};
    FreeLens free;
    double total = 0;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
        const Fragment& f = fragments[i];
        const double radius_px = geometry.coc_diameter_px(f.inverse_depth_per_m) / 2;
        const double beside = f.hidden.alpha > 0 ? as_near(fragments.subspan(i + 1), radius_px, geometry) : 0;
        const double along = std::min(moving_along(laid, radius_px) + beside, 1.0);
        const SurfaceLight light = kept_light(f, along);
        const double wanted = light.alpha * free.passing(light.alpha, light.lens[3], along);
        // No more than is free, and no less than cannot be covered by what is laid down.
        const double least = std::min(f.seen.alpha + f.hidden.alpha, 1.0) + free.mean - 1 - beside;
        const double got = std::clamp(wanted, std::max(least, 0.0), free.mean);
        const double limit = wanted > 0 ? got / wanted : 0;
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] += limit * light.rgb[c] * free.passing(light.rgb[c], light.lens[c], along);
        const double laid_down = wanted * limit;
        total += laid_down;
        const double alpha = std::min(light.alpha, 1.0);
        laid.push_back({radius_px, alpha});
        free.cover(laid_down, alpha, light.lens[3], along);
        if (free.mean < opaque) break;
    }
    if (!(total > 0)) return {};
    for (double& channel : rgb) channel /= total;
    return rgb;
}

}  // namespace postlens
