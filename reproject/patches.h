// Sheets divided into patches that are planar within the lens's resolution, so that a view moves each by an
// affine map.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "lens/focus_geometry.h"
#include "reproject/raster_map.h"
#include "reproject/raster_rect.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

/// Upper bounds of the distortion of a part of a sheet over several motions.
struct MotionStrain {
    double px_m = 0;     ///< RasterTangent::by_depth
    double bend_px = 0;  ///< RasterTangent::bend_px
};

/// The lens that patches are made for.
struct PatchLens {
    double radius_px_m = 0;  ///< px of CoC radius per 1/m of defocus
    double inverse_focus_per_m = 0;
    double bend_px_m2 = 0;  ///< px of reprojection error at the lens's rim per 1/m^2 of Record::w_bend
    /// A child node is drawn as part of its parent, not for itself, if its reprojection at the lens's rim
    /// differs by at most this, px. Negative: never; all_follow: always.
    double follow_px = default_follow_px;
    static constexpr double default_follow_px = 0.25, all_follow = std::numeric_limits<double>::infinity();
    double exact_px = 0.1;  ///< largest error of a cell's position in a view, px; larger where it is blurred
    /// Distance, px, by which a patch is drawn beyond its sides, so that neighbours with different planes
    /// leave no crack.
    double overlap_px = 0.02;
    /// Upper bounds of the motion of a part of a sheet over all views; none: nothing moves. `middle`, `slope`
    /// and `reach` are the arguments of RasterMap::tangent.
    std::function<MotionStrain(const SheetKey& key, const RasterPoint& middle, const glm::dvec2& slope,
                               const glm::dvec2& reach)>
        motion;

    /// Smaller semi-axis of the CoC ellipse of a node with this W, px.
    [[nodiscard]] double least_blur_px(const Mat2& w) const;
};
[[nodiscard]] PatchLens patch_lens(const FocusGeometry& geometry);

/// Largest error of a reprojection by W, px, for which a node counts as recorded; a patch above it is `bent`.
inline constexpr double most_bend_px = 0.5;

/// Cells [x, x + width) x [y, y + height) of a sheet.
struct Patch {
    std::uint32_t sheet = 0;
    std::uint8_t x = 0, y = 0, width = 0, height = 0;
    bool coarse = false;            ///< blurred over several pixels: uses SheetMesh::coarse
    bool bent = false;              ///< nonlinear W: its error exceeds most_bend_px somewhere
    std::uint8_t depth = 0;         ///< levels of its quadtrees that are used
    std::uint32_t first_plane = 0;  ///< index into PatchMesh::planes
    float back_per_m = 0;           ///< depth tests move the patch farther away by this, in 1/z'
};

/// The affine map of a patch into a view: (x, y) px from the patch's corner move to raster px `from + move *
/// (x, y)`.
struct PatchPlace {
    glm::dmat2 move{1};
    glm::dvec2 from{0};
    glm::dvec3 inverse_z{0};  ///< in the view: value at the patch's corner, slopes by x and y
};

struct PatchMesh {
    const SheetMesh* sheets = nullptr;
    float overlap_px = 0;  ///< PatchLens::overlap_px
    std::vector<Patch> patches;
    /// Per patch `sheets->values` planes with origin at the patch's corner: 1/z', xx, xy, yx, yy.
    std::vector<CellPlane> planes;
    /// Per sheet, bits (child_bit) of the child nodes that are drawn as part of it (PatchLens::follow_px).
    std::vector<std::uint8_t> follows;

    /// Bits (child_bit) of a texel's child nodes that are drawn for themselves.
    [[nodiscard]] std::uint8_t drawn_children(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::uint8_t children = t.children();
        return children == 0 ? children : static_cast<std::uint8_t>(children & ~follows[t.sheet()]);
    }
    /// Whether an edge cuts the texel's leaf in this node or in a child node that is drawn as part of it.
    [[nodiscard]] bool unsure(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        return t.unsure() || (t.unsure_below() && (t.children() & follows[t.sheet()]) != 0);
    }
    /// Radiance of a texel's child nodes that are drawn as part of it.
    [[nodiscard]] std::array<float, 3> following(std::uint32_t texel) const {
        std::array<float, 3> rgb{};
        const Texel& t = sheets->texels[texel];
        if (t.children() == 0) return rgb;
        const auto with = static_cast<std::uint32_t>(t.children() & follows[t.sheet()]);
        for (std::size_t bounce = 0; bounce < 2; ++bounce) {
            if ((with >> bounce & 1U) == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) rgb[c] += sheets->below[texel][bounce][c];
        }
        return rgb;
    }
    /// Radiance of a texel, with the child nodes that are drawn as part of it.
    [[nodiscard]] glm::vec3 light(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::array<float, 3> more = following(texel);
        return {t.r + more[0], t.g + more[1], t.b + more[2]};
    }
    /// Object id of a texel.
    [[nodiscard]] std::uint32_t id_of(std::uint32_t texel) const {
        return sheets->sheets[sheets->texels[texel].sheet()].key.id;
    }
    [[nodiscard]] const Sheet& sheet(const Patch& p) const { return sheets->sheets[p.sheet]; }
    /// Upper left corner of a patch, raster px.
    [[nodiscard]] glm::dvec2 corner(const Patch& p) const { return {sheet(p).x + p.x, sheet(p).y + p.y}; }
};

/// Divides sheets into the largest patches whose cells have a position error of at most PatchLens::exact_px
/// in every view, or of a fiftieth of the CoC radius if that is more; a patch has at least one cell.
///
/// Hidden sheets (SheetKey::hidden) get Patch::back_per_m, the largest depth error of two planes together: a
/// surface closely behind another one, as the cap in the end of an open cylinder, must not show through.
/// Deterministic.
[[nodiscard]] PatchMesh cut_patches(const SheetMesh& sheets, const PatchLens& lens);

/// Computes the map of a patch into a view: `motion`, to first order around the patch's centre, then the
/// shift of the lens. Returns false if the patch comes to lie behind the camera.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const RasterMap& motion,
                               const LensShift& lens, PatchPlace& out);

/// The rays from one scene point to all pixels of its CoC. Each pixel is reached through another lens point.
struct PointRays {
    glm::dvec2 at{0};  ///< the scene point, raster px
    /// The ray to pixel `at + d` passes through LensShift::lens_px = lens_px_per_px * d.
    glm::dmat2 lens_px_per_px{0};
    double inverse_focus_per_m = 0;
};

/// Computes the map of a primary patch into the view in which every pixel has the lens point of its ray of
/// `rays`. A patch that is nearer than the scene point hides it from the pixels it covers there. To first
/// order around the patch's centre. Returns false if the map is singular.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const PointRays& rays,
                               PatchPlace& out);
struct PlacedPatch {
    Patch patch;
    PatchPlace place;
};
/// Appends the parts of a patch that are nearer than `nearest_per_m`, which is at least `light_per_m`, the
/// depth of the scene point (both 1/z'). The map is singular at the scene point's depth, so parts near it are
/// small: within a part of several cells the distance in 1/z' from that depth varies by at most a factor of
/// two.
void place_nearer(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, double light_per_m,
                  double nearest_per_m, std::vector<PlacedPatch>& out);

/// Bounding rectangle of a patch in a view, raster px.
[[nodiscard]] RasterRect covered(const Patch& patch, const PatchPlace& place);

}  // namespace postlens
