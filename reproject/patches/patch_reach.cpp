#include "reproject/patches/patch_reach.h"

namespace postlens {

PatchReach patch_reach(const PatchMesh& mesh, const Patch& patch, const glm::dvec2& farthest_px,
                       double shift_px) {
    const CellPlane* p = mesh.planes.data() + patch.first_plane;
    const glm::dvec2 corner = mesh.corner(patch);
    const double half_x = patch.width / 2.0, half_y = patch.height / 2.0;
    const bool has_w = mesh.sheets->has_w();
    // `p` holds the patch's linear functions of the raster position. `p[0]` is the inverse depth. `xx` to
    // `yy` are the entries of the 2x2 matrix W, which tells how far the image moves with the lens point. For
    // directly visible surfaces, W is the unit matrix times the inverse depth.
    const CellPlane nothing, &xx = has_w ? p[1] : p[0], &xy = has_w ? p[2] : nothing,
                             &yx = has_w ? p[3] : nothing, &yy = has_w ? p[4] : p[0];
    const auto middle = [&](const CellPlane& w) {
        return static_cast<double>(w.value) + static_cast<double>(w.x) * half_x +
               static_cast<double>(w.y) * half_y;
    };
    const auto stretch = [&](const CellPlane& w) {
        return std::abs(static_cast<double>(w.x)) * half_x + std::abs(static_cast<double>(w.y)) * half_y;
    };
    PatchReach out;
    out.x = static_cast<float>(corner.x + half_x);
    out.y = static_cast<float>(corner.y + half_y);
    out.xx = static_cast<float>(middle(xx));
    out.xy = static_cast<float>(middle(xy));
    out.yx = static_cast<float>(middle(yx));
    out.yy = static_cast<float>(middle(yy));
    // Returns the margin, in px, by which the patch's bounding rectangle is extended on each side along one
    // axis. 0.25 px is more than enough for the overlap with which neighbouring patches are drawn, and 1e-6
    // of the positions and displacements is added for rounding.
    const auto margin = [&](double at, float by_x, float by_y) {
        return 0.25 + 1e-6 * (std::abs(at) + shift_px + std::abs(static_cast<double>(by_x)) * farthest_px.x +
                              std::abs(static_cast<double>(by_y)) * farthest_px.y);
    };
    out.half_width = static_cast<float>(half_x + stretch(xx) * farthest_px.x + stretch(xy) * farthest_px.y +
                                        margin(corner.x, out.xx, out.xy));
    out.half_height = static_cast<float>(half_y + stretch(yx) * farthest_px.x + stretch(yy) * farthest_px.y +
                                         margin(corner.y, out.yx, out.yy));
    return out;
}

}  // namespace postlens
