#include "focus/responses/node_response.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// Blur radius, in px, from which the subpixel position of a blur kernel is rounded to quarter pixels (see
/// phases_of). Smaller kernels that take long to compute are treated as if they had this radius, so that
/// fewer kernels are needed.
constexpr double few_phases_from_px = 17;
/// Ellipses that differ from a circle by less than this, in px, are treated as circles.
constexpr double round_within_px = 0.05;

}  // namespace

NodeResponse NodeResponses::to_depth(double inverse_depth_per_m, const glm::dvec2& place_px) const {
    NodeResponse out;
    const bool round = response_->is_round();
    const double signed_radius_px = geometry_.coc_diameter_px(inverse_depth_per_m) / 2;
    out.exact_radius_px = std::abs(signed_radius_px);
    out.farthest_px = round ? out.exact_radius_px : response_->farthest_light_px(signed_radius_px);
    if (const auto level = levels_.level_of(inverse_depth_per_m)) {
        out.key = KernelKey::disc(*level);
        out.radius_px = levels_.radius_px()[*level];
        if (!round) {
            out.key.upside_down = signed_radius_px < 0 && !response_->is_point_symmetric();
            finish_other(out, glm::dmat2(std::copysign(out.radius_px, signed_radius_px)), place_px);
        }
        return out;
    }
    out.radius_px = std::max(out.exact_radius_px, DepthLevels::smallest_radius_px);
    out.key = round ? KernelKey::ellipse(Ellipse::disc(out.radius_px))
                    : KernelKey::map(glm::dmat2(signed_radius_px));
    if (!round) finish_other(out, glm::dmat2(signed_radius_px), place_px);
    return out;
}

void NodeResponses::finish_other(NodeResponse& out, const glm::dmat2& map_px,
                                 const glm::dvec2& place_px) const {
    out.radius_px = response_->reach_px(map_px);
    const double cell_px = response_->cell_px(map_px);
    if (cell_px == 0) return;
    out.key.cell_log2 = std::ilogb(cell_px);
    // Computes the inverse depth for which the transmittance of the lens is computed. It is that of a point
    // with this blur: its signed blur radius is the mean of the two diagonal entries of `map_px`, which
    // converts lens points to px.
    out.inverse_depth_per_m =
        geometry_.inverse_focus_per_m -
        (map_px[0].x + map_px[1].y) / 2 / (geometry_.gain_px * geometry_.aperture_radius_m);
    const glm::dvec2 cell = glm::floor(place_px * std::ldexp(1.0, -out.key.cell_log2));
    out.key.cell_x = static_cast<std::int32_t>(cell.x);
    out.key.cell_y = static_cast<std::int32_t>(cell.y);
}

NodeResponse NodeResponses::to_w(const Mat2& w, const glm::dvec2& place_px) const {
    const double xx = w.xx, xy = w.xy, yx = w.yx, yy = w.yy;
    const double scale = geometry_.gain_px * geometry_.aperture_radius_m;
    if (std::max({std::abs(xx - yy), std::abs(xy), std::abs(yx)}) * scale < round_within_px ||
        !response_->takes_maps()) {
        return to_depth((xx + yy) / 2, place_px);
    }
    // Computes the matrix that converts a lens point, in lens radii, to the displacement of the surface
    // point's image, in px. The 2x2 matrix W, with the entries xx, xy, yx and yy, describes this displacement
    // for an unfocused lens. Focusing at the inverse distance s turns it into s - W.
    const double s = geometry_.inverse_focus_per_m;
    // The constructor takes the columns of the matrix, so yx comes before xy.
    const glm::dmat2 map(scale * (s - xx), -scale * yx, -scale * xy, scale * (s - yy));
    NodeResponse out;
    if (!response_->is_round()) {
        out.key = KernelKey::map(map);
        finish_other(out, map, place_px);
        out.exact_radius_px = out.radius_px;
        return out;
    }
    const Ellipse e = Ellipse::from_map(map, DepthLevels::smallest_radius_px);
    out.radius_px = std::max(e.half_height, e.half_width());
    out.exact_radius_px = out.radius_px;
    out.key = KernelKey::ellipse(e);
    return out;
}

NodeResponse NodeResponses::of(const Record& node, const NodeResponse& primary,
                               const glm::dvec2& place_px) const {
    switch (model_) {
        case DepthModel::first_hit:
            return primary;
        case DepthModel::path:
            return to_depth(1 / static_cast<double>(node.z), place_px);
        case DepthModel::ray_differentials:
            break;
    }
    return to_w(node.w, place_px);
}

float NodeResponses::passing(const NodeResponse& response, const glm::dvec2& place_px) const {
    return response.key.cell_log2 == 0
               ? 1.0F
               : static_cast<float>(response_->transmission(place_px, response.inverse_depth_per_m));
}

Phases NodeResponses::phases(const PointSample& sample, const NodeResponse& response) const {
    return phases_of(
        sample, std::max(response.radius_px,
                         response_->few_phases_from_px() <= response.radius_px ? few_phases_from_px : 0.0));
}

}  // namespace postlens
