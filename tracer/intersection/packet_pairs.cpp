#include "tracer/intersection/packet_pairs.h"

#include <cmath>
#include <limits>

#include "core/multiversion.h"

namespace postlens {
namespace {

template <int N>
[[gnu::always_inline]] inline void local_rays(const AnalyticSet::Item& item, const Rays& rays,
                                              float (&o)[3][N], float (&d)[3][N]) {
    const glm::mat3 m = item.linear;
    const glm::vec3 pivot = item.pivot, shift = item.shift;
    for (int i = 0; i < N; ++i) {
        const float px = rays.ox[i] - pivot.x, py = rays.oy[i] - pivot.y, pz = rays.oz[i] - pivot.z;
        const float vx = rays.dx[i], vy = rays.dy[i], vz = rays.dz[i];
        for (int axis = 0; axis < 3; ++axis) {
            o[axis][i] = (m[0][axis] * px + m[1][axis] * py + m[2][axis] * pz) + shift[axis];
            d[axis][i] = m[0][axis] * vx + m[1][axis] * vy + m[2][axis] * vz;
        }
    }
}

template <int N>
[[gnu::always_inline]] inline void flat_lanes(const AnalyticSet::Item& item, const Rays& rays, Pairs& out) {
    alignas(64) float o[3][N], d[3][N];
    local_rays<N>(item, rays, o, d);
    constexpr float none = std::numeric_limits<float>::infinity();
    const bool rectangle = item.shape.kind == AnalyticShape::Kind::rectangle;
    const bool disc = item.shape.kind == AnalyticShape::Kind::disc;
    const auto inner2 = static_cast<float>(item.shape.inner * item.shape.inner);
    for (int i = 0; i < N; ++i) {
        const float t = -o[2][i] / d[2][i];
        const float x = o[0][i] + t * d[0][i], y = o[1][i] + t * d[1][i];
        const float r2 = x * x + y * y;
        const bool in_rectangle = (x >= 0) & (x <= 1) & (y >= 0) & (y <= 1);
        const bool in_disc = (r2 <= 1) & (r2 >= inner2);
        const bool in = (d[2][i] != 0) & (!rectangle | in_rectangle) & (!disc | in_disc);
        out.near[i] = in ? t : none;
        out.far[i] = none;
    }
}

template <int N>
[[gnu::always_inline]] inline void box_lanes(const AnalyticSet::Item& item, const Rays& rays, Pairs& out) {
    alignas(64) float o[3][N], d[3][N];
    local_rays<N>(item, rays, o, d);
    constexpr float none = std::numeric_limits<float>::infinity();
    for (int i = 0; i < N; ++i) {
        float t_in = -none, t_out = none;
        bool missed = false;
        for (int axis = 0; axis < 3; ++axis) {
            const float from = o[axis][i], along = d[axis][i];
            const float t0 = -from / along, t1 = (1.0F - from) / along;
            const bool parallel = along == 0;
            const float low = t0 > t1 ? t1 : t0, high = t0 > t1 ? t0 : t1;
            t_in = (!parallel & (low > t_in)) ? low : t_in;
            t_out = (!parallel & (high < t_out)) ? high : t_out;
            missed = missed | (parallel & ((from < 0) | (from > 1)));
        }
        const bool hit = !missed & !(t_in > t_out);
        out.near[i] = hit ? t_in : none;
        out.far[i] = hit ? t_out : none;
    }
}

// Finds the first and the last crossing of each of N rays with a cone. There are no others, because a cone
// with caps is convex, and the lateral surface alone is a quadric, which a ray crosses at most twice.
template <int N>
[[gnu::always_inline]] inline void cone_lanes(const AnalyticSet::Item& item, const Rays& rays, Pairs& out) {
    alignas(64) float o[3][N], d[3][N];
    local_rays<N>(item, rays, o, d);
    constexpr float none = std::numeric_limits<float>::infinity();
    const auto h = static_cast<float>(item.shape.height), r0 = static_cast<float>(item.shape.radius0),
               r1 = static_cast<float>(item.shape.radius1);
    const float k = (r1 - r0) / h;
    const bool capped = item.shape.capped;
    for (int i = 0; i < N; ++i) {
        const float dx = d[0][i], dy = d[1][i], dz = d[2][i];
        const float shift =
            -(o[0][i] * dx + o[1][i] * dy + (o[2][i] - h / 2) * dz) / (dx * dx + dy * dy + dz * dz);
        const float px = o[0][i] + shift * dx, py = o[1][i] + shift * dy, pz = o[2][i] + shift * dz;
        const float r = r0 + k * pz;
        const float a = dx * dx + dy * dy - k * k * dz * dz;
        const float half_b = px * dx + py * dy - r * k * dz;
        const float c = px * px + py * py - r * r;
        const float discriminant = half_b * half_b - a * c;
        const bool real = discriminant >= 0;
        const float q = -(half_b + std::copysign(std::sqrt(real ? discriminant : 0.0F), half_b));
        // Computes the ray parameters t0 and t1 at which the ray crosses the infinite cone. They are the
        // solutions q / a and c / q of a t^2 + 2 half_b t + c = 0, where q is computed without cancellation
        // of digits. If q is 0, the ray can only touch the cone at t = 0.
        const float t0 = q / a, t1 = q == 0 ? 0.0F : c / q;
        const float z0 = pz + t0 * dz, z1 = pz + t1 * dz;
        const bool on0 = real & (a != 0) & (z0 >= 0) & (z0 <= h) & (r0 + k * z0 >= 0);
        const bool on1 = real & ((q != 0) | (a != 0)) & (z1 >= 0) & (z1 <= h) & (r0 + k * z1 >= 0);
        const float base = -pz / dz, apex = (h - pz) / dz;
        const float bx = px + base * dx, by = py + base * dy, ax = px + apex * dx, ay = py + apex * dy;
        const bool flat = capped & (dz != 0);
        const bool on_base = flat & (bx * bx + by * by <= r0 * r0),
                   on_apex = flat & (ax * ax + ay * ay <= r1 * r1);
        float first = none, last = -none;
        first = (on0 & (t0 < first)) ? t0 : first;
        last = (on0 & (t0 > last)) ? t0 : last;
        first = (on1 & (t1 < first)) ? t1 : first;
        last = (on1 & (t1 > last)) ? t1 : last;
        first = (on_base & (base < first)) ? base : first;
        last = (on_base & (base > last)) ? base : last;
        first = (on_apex & (apex < first)) ? apex : first;
        last = (on_apex & (apex > last)) ? apex : last;
        out.near[i] = shift + first;  // infinite if there is no crossing
        out.far[i] = last > first ? shift + last : none;
    }
}

POSTLENS_MULTIVERSION void flat_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                      Pairs& out) {
    if (n == 8) {
        flat_lanes<8>(item, rays, out);
    } else {
        flat_lanes<16>(item, rays, out);
    }
}
POSTLENS_MULTIVERSION void box_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                     Pairs& out) {
    if (n == 8) {
        box_lanes<8>(item, rays, out);
    } else {
        box_lanes<16>(item, rays, out);
    }
}
POSTLENS_MULTIVERSION void cone_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                      Pairs& out) {
    if (n == 8) {
        cone_lanes<8>(item, rays, out);
    } else {
        cone_lanes<16>(item, rays, out);
    }
}

}  // namespace

bool packet_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n, const RayContext& context,
                  unsigned geometry, unsigned primitive, const int* valid, Pairs& out) {
    if (n != 8 && n != 16) return false;
    if (item.shape.flat()) {
        flat_pairs(item, rays, n, out);
    } else if (item.shape.kind == AnalyticShape::Kind::box) {
        box_pairs(item, rays, n, out);
    } else if (item.shape.kind == AnalyticShape::Kind::cone) {
        cone_pairs(item, rays, n, out);
    } else {
        return false;
    }
    if (context.sources == nullptr) return true;
    for (unsigned i = 0; i < n; ++i) {
        if (valid[i] == 0 || !leaves(context, rays.id[i], geometry, primitive)) continue;
        // The ray starts on this shape. So the crossing whose distance is nearer to 0 is its own origin, and
        // is removed.
        float& start = std::abs(out.far[i]) < std::abs(out.near[i]) ? out.far[i] : out.near[i];
        start = std::numeric_limits<float>::infinity();
    }
    return true;
}

}  // namespace postlens
