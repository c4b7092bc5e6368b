#include "lens/traced/pupil_fan.h"

#include <algorithm>
#include <cmath>

#include "lens/cell_deposit.h"
#include "lens/traced/lit_outline.h"
#include "lens/traced/meridional_rotation.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr std::size_t rings = PupilFan::rings, spokes = PupilFan::spokes;

double cross(const dvec2& a, const dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Traces rays of one object point.
class PointRays {
  public:
    PointRays(const LensView& view, double inverse_depth_per_m, double tangent)
        : view_(view), lens_(view.lens()), inverse_depth_per_m_(inverse_depth_per_m), tangent_(0, tangent) {}

    [[nodiscard]] bool passes(const dvec2& pupil_m) const {
        LensRay ray = ray_through(pupil_m);
        return lens_.stack().forward(ray).passes();
    }
    [[nodiscard]] PupilFan::Node node(const dvec2& pupil_m, const dvec2& fallback) const {
        const dvec2 slope = tangent_ - inverse_depth_per_m_ * pupil_m;
        const double square = 1 + glm::dot(slope, slope);
        PupilFan::Node out{pupil_m, fallback, 1 / (square * square)};
        LensRay ray = ray_through(pupil_m);
        if (lens_.stack().forward(ray, Apertures::ignored).passes())
            out.landing = view_.straightened(lens_.on_film(ray)) - tangent_;
        return out;
    }

  private:
    [[nodiscard]] LensRay ray_through(const dvec2& pupil_m) const {
        return {dvec3(1e3 * pupil_m, lens_.pinhole_from_vertex_mm()),
                glm::normalize(dvec3(inverse_depth_per_m_ * pupil_m - tangent_, 1))};
    }

    const LensView& view_;
    const TracedLens& lens_;
    double inverse_depth_per_m_;
    dvec2 tangent_;
};

}  // namespace

bool trace_fan(const LensView& view, double inverse_depth_per_m, double tangent, dvec2& near_m,
               PupilFan& out) {
    const PointRays rays(view, inverse_depth_per_m, tangent);
    const LitOutline lit([&rays](const dvec2& pupil_m) { return rays.passes(pupil_m); },
                         view.geometry().aperture_radius_m);
    std::array<dvec2, spokes + 1> edge;
    if (!lit.find(near_m, edge)) return false;
    const PupilFan::Node middle = rays.node(near_m, dvec2(0));
    for (std::size_t j = 0; j <= spokes; ++j) {
        out.at(0, j) = middle;
        for (std::size_t i = 1; i <= rings; ++i) {
            out.at(i, j) =
                rays.node(glm::mix(near_m, edge[j], PupilFan::ring_radius(i)), out.at(i - 1, j).landing);
        }
    }
    return true;
}

namespace {

/// One ray of a fan, placed on the raster to compute the object point's impulse response.
struct Placed {
    dvec2 px{0};     ///< landing point, px from the response's raster position
    dvec2 pupil{0};  ///< where the ray passes the pupil
    double light = 0;
};

Placed placed(const PupilFan::Node& node, const FanImage& image, double side) {
    const dvec2 pupil(side * node.pupil_m.x, node.pupil_m.y);
    const dvec2 landing(side * node.landing.x, node.landing.y);
    return {image.centre_px + image.gain_px * turned(landing, image.axis) +
                image.further_px_m * turned(pupil, image.axis),
            pupil, node.light};
}

}  // namespace

double fan_reach_px(const PupilFan& fan, const FanImage& image) {
    double out = 0;
    for (const PupilFan::Node& node : fan.nodes) {
        for (const double side : {-1.0, 1.0})
            out = std::max(out, glm::length(placed(node, image, side).px - image.centre_px));
    }
    return out;
}

ResponseGrid fan_response(const PupilFan& fan, const FanImage& image, const PixelWindow& window) {
    constexpr std::size_t per_side = (rings + 1) * (spokes + 1);
    std::array<Placed, 2 * per_side> nodes;
    dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        nodes[k] = placed(fan.nodes[k % per_side], image, k < per_side ? -1 : 1);
        low = glm::min(low, nodes[k].px);
        high = glm::max(high, nodes[k].px);
    }
    // In the pupil, the rays of a fan form a mesh of rings and spokes. A small impulse response covers few
    // pixels, so only every second or fourth ring and spoke is used, which saves time. This displaces the
    // outline of the impulse response by less than 0.03 px.
    const double extent_px = std::max(high.x - low.x, high.y - low.y) / 2;
    const std::size_t stride = extent_px < 1.5 ? 4 : extent_px < 16 ? 2 : 1;
    const auto cut = [](double at, int begin, int end) {
        return static_cast<int>(
            std::clamp(std::floor(at), static_cast<double>(begin), static_cast<double>(end)));
    };
    const int x = cut(low.x, window.x_begin, window.x_end), y = cut(low.y, window.y_begin, window.y_end);
    ResponseGrid grid(x, y, cut(high.x + 1, window.x_begin, window.x_end) - x,
                      cut(high.y + 1, window.y_begin, window.y_end) - y);
    if (grid.share.empty()) return {};
    CellDeposit deposit(grid);
    double total = 0;
    const auto light_of = [](const Placed& a, const Placed& b, const Placed& c) {
        return std::abs(cross(b.pupil - a.pupil, c.pupil - a.pupil)) / 2 * (a.light + b.light + c.light) / 3;
    };
    const auto visit = [&](auto&& take) {
        for (std::size_t side = 0; side < nodes.size(); side += per_side) {
            for (std::size_t j = 0; j < spokes; j += stride) {
                for (std::size_t i = 0; i < rings; i += stride) {
                    const Placed* a = &nodes[side + i * (spokes + 1) + j];
                    const Placed* b = a + stride * (spokes + 1);
                    take(*a, *b, b[stride], a[stride]);
                }
            }
        }
    };
    visit([&](const Placed& a, const Placed& b, const Placed& c, const Placed& d) {
        total += light_of(a, b, c) + light_of(a, c, d);
    });
    if (!(total > 0)) return {};
    visit([&](const Placed& a, const Placed& b, const Placed& c, const Placed& d) {
        const double first = light_of(a, b, c) / total, second = light_of(a, c, d) / total;
        const double turn_b = cross(b.px - a.px, c.px - b.px), turn_d = cross(d.px - c.px, a.px - d.px),
                     turn_c = cross(c.px - b.px, d.px - c.px), turn_a = cross(a.px - d.px, b.px - a.px);
        const bool left = turn_a >= 0 && turn_b >= 0 && turn_c >= 0 && turn_d >= 0;
        const bool right = turn_a <= 0 && turn_b <= 0 && turn_c <= 0 && turn_d <= 0;
        if (left || right) {
            deposit.add(std::array{a.px, b.px, c.px, d.px}, first + second);
            return;
        }
        // a, b, c and d are the rays through the four corners of a cell of the pupil. The points at which
        // they land do not form a convex quadrilateral, so its outline may cross itself. Therefore, the cell
        // is split into two triangles, with the energies `first` and `second`.
        if (first > 0) deposit.add(std::array{a.px, b.px, c.px}, first);
        if (second > 0) deposit.add(std::array{a.px, c.px, d.px}, second);
    });
    deposit.finish();
    return grid;
}

}  // namespace postlens
