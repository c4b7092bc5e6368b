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

/// A share of the pixel's light over the lens: S(q) = mean + 4 tilt . q.
struct OverLens {
    double mean = 0;
    LensMoment tilt;

    void add(const OverLens& other, double times) {
        mean += times * other.mean;
        tilt.x += times * other.tilt.x;
        tilt.y += times * other.tilt.y;
    }
    /// How much passes, 0 to 1, of something with this sum and moment.
    [[nodiscard]] double passing(double sum, const LensMoment& moment) const {
        if (sum == 0) return 0;
        return std::clamp(mean + 4 * (tilt.x * moment.x + tilt.y * moment.y) / sum, 0.0, 1.0);
    }
};

/// A surface that has been laid down.
struct Laid {
    double radius_px;
    double alpha;    ///< as if nothing independent of it stood before it
    OverLens cover;  ///< what it holds back
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

/// What has been laid down and moves along with a surface: how much of the pinhole's view it takes, and what
/// of the lens. Going forward the radii part, and from some surface on all are independent.
struct Along {
    double alpha = 0;
    OverLens cover;
};

Along moving_along(std::span<const Laid> laid, double radius_px) {
    Along out;
    for (std::size_t i = laid.size(); i-- > 0;) {
        const double apart = independence(radius_px, laid[i].radius_px);
        if (apart >= 1) break;
        out.alpha += (1 - apart) * laid[i].alpha;
        out.cover.add(laid[i].cover, 1 - apart);
    }
    return out;
}

/// Which of two surfaces that pass through each other is the nearer one, their mean depths in a pixel do not
/// say: what is seen of those that come next, within half a pixel of radius, may be before this one as well.
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
    OverLens free{.mean = 1, .tilt = {}};
    double total = 0;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
        const Fragment& f = fragments[i];
        const double radius_px = geometry.coc_diameter_px(f.inverse_depth_per_m) / 2;
        const Along along = moving_along(laid, radius_px);
        const double beside = f.hidden.alpha > 0 ? as_near(fragments.subspan(i + 1), radius_px, geometry) : 0;
        const SurfaceLight light = kept_light(f, std::min(along.alpha + beside, 1.0));
        // What moves along has been taken from the surface itself, not from the lens.
        OverLens open = free;
        open.add(along.cover, 1);
        const double wanted = light.alpha * open.passing(light.alpha, light.lens[3]);
        // No more than is free, and no less than cannot be covered.
        const double least = std::min(f.seen.alpha + f.hidden.alpha, 1.0) + free.mean - 1 - beside;
        const double got = wanted > 0 ? std::clamp(wanted, std::max(least, 0.0), free.mean) : 0;
        const double limit = wanted > 0 ? got / wanted : 0;
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] += limit * light.rgb[c] * open.passing(light.rgb[c], light.lens[c]);
        total += got;
        // The product of two linear functions, without its quadratic part.
        const double alpha = std::min(light.alpha, 1.0);
        const OverLens cover{got,
                             {open.mean * light.lens[3].x + alpha * open.tilt.x,
                              open.mean * light.lens[3].y + alpha * open.tilt.y}};
        laid.push_back({radius_px, alpha, cover});
        free.add(cover, -1);
        if (free.mean < opaque) break;
        // No part of the disc has a greater moment: a half of it 0.21, a small part at the rim its own size.
        const double most = free.mean * (1 - free.mean), is = std::hypot(free.tilt.x, free.tilt.y);
        if (is > most) free.tilt = {free.tilt.x * (most / is), free.tilt.y * (most / is)};
    }
    if (!(total > 0)) return {};
    for (double& channel : rgb) channel /= total;
    return rgb;
}

}  // namespace postlens
