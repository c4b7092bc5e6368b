#include "focus/layers/visibility.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace postlens {

double independence(double radius_px, double other_px) {
    const double larger = std::max(std::abs(radius_px), std::abs(other_px));
    return std::min(1.0, std::abs(radius_px - other_px) / (larger + 1));
}

namespace {

/// A function over the lens: how much light (transmittance) or how much of a pixel (coverage) each lens point
/// sees. It is approximated as linear. `mean` is its mean over the lens, and `tilt` the mean of its value
/// times q. At the lens point q, in lens radii, its value is mean + 4 tilt . q, because the mean of q.x^2 is
/// 1/4.
///
/// If two linear functions have the means m1, m2 and the tilts t1, t2, their product has the mean and tilt:
///
///     m1 m2 + 4 t1 . t2,   m1 t2 + m2 t1
struct OverLens {
    double mean = 0;
    LensMoment tilt;

    void add(const OverLens& other, double times) {
        mean += times * other.mean;
        tilt.x += times * other.tilt.x;
        tilt.y += times * other.tilt.y;
    }
    /// Returns the fraction (0 to 1) of a surface's light that passes the surfaces in front, whose
    /// transmittance is this object. The light varies over the lens, too.
    /// - `sum`: mean of the light over the lens
    /// - `moment`: its tilt, which tells on which side of the lens it is brighter
    [[nodiscard]] double passing(double sum, const LensMoment& moment) const {
        const double varies = sum == 0 ? 0 : 4 * (tilt.x * moment.x + tilt.y * moment.y) / sum;
        return std::clamp(mean + varies, 0.0, 1.0);
    }
};

/// A surface that has already been composited at the pixel. Surfaces are composited from front to back.
struct Laid {
    double radius_px;
    OverLens cover;  ///< its coverage over the lens
};

template <typename Before>
void sort(std::span<Fragment> fragments, const Before& before) {
    constexpr std::size_t few = 16;
    if (fragments.size() > few) {
        std::stable_sort(fragments.begin(), fragments.end(), before);
        return;
    }
    for (std::size_t i = 1; i < fragments.size(); ++i) {
        const Fragment f = fragments[i];
        std::size_t k = i;
        for (; k > 0 && before(f, fragments[k - 1]); --k) fragments[k] = fragments[k - 1];
        fragments[k] = f;
    }
}

void sort_by_depth(std::span<Fragment> fragments) {
    sort(fragments,
         [](const Fragment& a, const Fragment& b) { return a.inverse_depth_per_m > b.inverse_depth_per_m; });
    // Sorts surfaces at the same depth by alpha (covered fraction of the pixel), with the smallest first.
    // Otherwise, rounding errors of the depth could put a small light source behind the wall on which it
    // lies, and the wall would hide it.
    constexpr double one_plane = 1e-5;
    for (std::size_t begin = 0, end = 1; begin < fragments.size(); begin = end++) {
        while (end < fragments.size() &&
               fragments[end].inverse_depth_per_m >= (1 - one_plane) * fragments[end - 1].inverse_depth_per_m)
            ++end;
        if (end - begin < 2) continue;
        sort(fragments.subspan(begin, end - begin), [](const Fragment& a, const Fragment& b) {
            return a.seen.alpha + a.hidden.alpha < b.seen.alpha + b.hidden.alpha;
        });
    }
}

}  // namespace

namespace {

/// The part of a surface's light that arrives at the pixel, because the surfaces in front transmit it. Colour
/// and alpha are summed separately, because they may vary differently over the lens. For example, a bright
/// spot may be visible from only one side of the lens.
struct Arrived {
    std::array<double, 3> rgb{};
    double alpha = 0;
    LensMoment lens;  ///< lens moment of alpha

    void add(const SurfaceLight& light, double times, const OverLens& open) {
        if (!(times > 0)) return;
        const double shown = times * open.passing(light.rgb[0] + light.rgb[1] + light.rgb[2], light.lens.rgb);
        for (std::size_t c = 0; c < 3; ++c) rgb[c] += shown * light.rgb[c];
        const double whole = times * light.alpha;
        alpha += whole * open.passing(light.alpha, light.lens.alpha);
        // Adds the tilt of the alpha that arrives. This alpha is the product of two linear functions over the
        // lens: the alpha of `light`, and the transmittance `open` of the surfaces in front. Each line adds
        // the two terms of the product's tilt (see OverLens).
        lens.x += times * open.mean * light.lens.alpha.x + std::min(whole, 1.0) * open.tilt.x;
        lens.y += times * open.mean * light.lens.alpha.y + std::min(whole, 1.0) * open.tilt.y;
    }
};

/// Returns how much of the pixel is covered by those nearer surfaces that move together with a new surface
/// when the lens point moves. Surfaces move in the image in proportion to their signed CoC radius, so these
/// are surfaces with a similar radius. A surface counts fully if the radii are equal.
/// - `laid`: the nearer surfaces at the pixel, which have already been composited
/// - `radius_px`: signed CoC radius of the new surface
OverLens moving_along(std::span<const Laid> laid, double radius_px) {
    OverLens out;
    for (std::size_t i = laid.size(); i-- > 0;) {
        const double apart = independence(radius_px, laid[i].radius_px);
        if (apart >= 1) break;
        out.add(laid[i].cover, 1 - apart);
    }
    return out;
}

}  // namespace

std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry) {
    constexpr double opaque = 1e-9;
    if (fragments.size() == 1 && fragments[0].hidden.alpha == 0) {
        // Shortcut: most pixels show only one surface, which nothing hides.
        std::array<double, 3> rgb = fragments[0].seen.rgb;
        for (double& channel : rgb) channel /= fragments[0].seen.alpha;
        return rgb;
    }
    sort_by_depth(fragments);
    thread_local std::vector<Laid> laid;
    laid.clear();
    std::array<double, 3> rgb{};
    OverLens free{.mean = 1, .tilt = {}};
    double total = 0;
    for (const Fragment& f : fragments) {
        const double radius_px = geometry.coc_diameter_px(f.inverse_depth_per_m) / 2;
        // Computes `open`, the transmittance of the nearer surfaces for `f.seen`, the part of this surface
        // that the pinhole sees. A nearer surface at almost the same depth hides `f.seen` from no lens point,
        // because both move together. Therefore, its coverage is added to `free`, the transmittance of all
        // nearer surfaces.
        OverLens open = free;
        open.add(moving_along(laid, radius_px), 1);
        Arrived light;
        light.add(f.seen, 1, open);
        if (f.hidden.alpha > 0) light.add(f.hidden, 1 - f.covered / f.hidden.alpha, free);
        const double whole = f.seen.alpha + f.hidden.alpha;
        const double least = std::min(whole, 1.0) - std::max(1 - free.mean, f.covered);
        const double got = std::clamp(light.alpha, std::max(least, 0.0), free.mean);
        // `light` is the part of this surface's light that the nearer surfaces transmit. The linear
        // approximation may make its alpha less than `least`, although the nearer surfaces cannot cover so
        // much. Then a part of the blocked light is added until the alpha is `least`. Scaling the light that
        // arrives would be wrong: if it is very small, this could make the pixel arbitrarily bright.
        const double kept = got < light.alpha ? got / light.alpha : 1;
        const double regained = got > light.alpha ? (got - light.alpha) / (whole - light.alpha) : 0;
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] += kept * light.rgb[c] + regained * (f.seen.rgb[c] + f.hidden.rgb[c] - light.rgb[c]);
        total += got;
        const OverLens cover{got, light.lens};
        laid.push_back({radius_px, cover});
        free.add(cover, -1);
        if (free.mean < opaque) break;
        // `free` is the transmittance of all surfaces composited so far, as a linear function over the lens.
        // If its values lie between 0 and 1 and its mean is A, its tilt is at most A (1 - A). The linear
        // approximation may exceed this, so the tilt is limited.
        const double most = free.mean * (1 - free.mean),
                     is = std::sqrt(free.tilt.x * free.tilt.x + free.tilt.y * free.tilt.y);
        if (is > most) free.tilt = {free.tilt.x * (most / is), free.tilt.y * (most / is)};
    }
    if (!(total > 0)) return {};
    for (double& channel : rgb) channel /= total;
    return rgb;
}

}  // namespace postlens
