#include "lens/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace postlens {
namespace {

using glm::dvec2;
constexpr double pi = std::numbers::pi;

double cross(const dvec2& a, const dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Number of chords that approximate an arc of `angle` (rad) within `tolerance`.
int chords_for(double angle, double radius, double tolerance) {
    const double cosine = std::clamp(1 - tolerance / radius, -1.0, 1.0);
    const double widest = 2 * std::acos(cosine);
    constexpr double most = 1 << 14;
    return static_cast<int>(std::clamp(std::ceil(angle / widest), 1.0, most));
}

}  // namespace

Outline circle_outline(double tolerance) {
    const int n = std::max(8, chords_for(2 * pi, 1, tolerance));
    const double step = 2 * pi / n;
    const double radius = std::sqrt(step / std::sin(step));
    Outline out;
    for (int i = 0; i < n; ++i) out.emplace_back(radius * std::cos(i * step), radius * std::sin(i * step));
    return out;
}

Outline blades_outline(int blades, double rotation_deg, double roundness, double tolerance) {
    const double half = pi / blades;
    const double sagitta = roundness * (1 - std::cos(half)), half_side = std::sin(half);
    Outline out;
    for (int k = 0; k < blades; ++k) {
        const double middle = rotation_deg * pi / 180 + (2 * k + 1) * half;
        const dvec2 outward(std::cos(middle), std::sin(middle)), along(-outward.y, outward.x);
        const dvec2 centre_of_side = std::cos(half) * outward;
        if (sagitta <= tolerance) {
            out.push_back(centre_of_side - half_side * along);
            continue;
        }
        // Replaces a side of the polygon by a circular arc through its corners. The sagitta is the arc's
        // height above the side.
        const double radius = (half_side * half_side + sagitta * sagitta) / (2 * sagitta);
        const double half_angle = std::asin(std::min(1.0, half_side / radius));
        const int n = chords_for(2 * half_angle, radius, tolerance);
        const dvec2 centre = centre_of_side + (sagitta - radius) * outward;
        for (int i = 0; i < n; ++i) {
            const double angle = half_angle * (2.0 * i / n - 1);
            out.push_back(centre + radius * (std::cos(angle) * outward + std::sin(angle) * along));
        }
    }
    return out;
}

Outline intersection(const Outline& a, const Outline& b) {
    Outline out = a, next;
    std::vector<double> sides;  // positive inside of the half-plane
    for (std::size_t i = 0; i < b.size() && !out.empty(); ++i) {
        const dvec2 from = b[i], along = b[(i + 1) % b.size()] - from;
        sides.resize(out.size());
        bool cuts = false;
        for (std::size_t k = 0; k < out.size(); ++k) {
            sides[k] = cross(along, out[k] - from);
            cuts |= !(sides[k] >= 0);
        }
        if (!cuts) continue;
        next.clear();
        for (std::size_t k = 0; k < out.size(); ++k) {
            const std::size_t after = k + 1 < out.size() ? k + 1 : 0;
            const dvec2 p = out[k], q = out[after];
            const double side_p = sides[k], side_q = sides[after];
            if (side_p >= 0) next.push_back(p);
            if ((side_p > 0 && side_q < 0) || (side_p < 0 && side_q > 0))
                next.push_back(p + side_p / (side_p - side_q) * (q - p));
        }
        std::swap(out, next);
    }
    if (out.size() < 3) out.clear();
    return out;
}

double area(const Outline& outline) {
    double twice = 0;
    for (std::size_t i = 0; i < outline.size(); ++i)
        twice += cross(outline[i], outline[(i + 1) % outline.size()]);
    return twice / 2;
}

}  // namespace postlens
