// Divides the recorded surfaces into patches. A patch is nearly planar, so an affine map can reproject it to
// a view.
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
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Upper bounds of the distortion of a part of a surface by several motions.
struct MotionStrain {
    double px_m = 0;     ///< RasterTangent::by_depth
    double bend_px = 0;  ///< RasterTangent::bend_px
};

/// The lens that patches are made for.
struct PatchLens {
    double radius_px_m = 0;  ///< CoC radius, px, per 1/m of defocus
    double inverse_focus_per_m = 0;
    double bend_px_m2 = 0;  ///< reprojection error at the lens's rim, px, per 1/m^2 of Record::w_bend
    /// A reflected or transmitted node is drawn as part of its parent node if the two positions, seen from
    /// the lens's rim, differ by at most this, px. Otherwise it is drawn separately. If negative, it is
    /// always drawn separately; with all_follow, never.
    double follow_px = default_follow_px;
    static constexpr double default_follow_px = 0.25, all_follow = std::numeric_limits<double>::infinity();
    double exact_px = 0.1;  ///< largest error of a cell's position in a view, px; blurred cells may have more
    /// Distance, px, by which a patch is drawn beyond its sides. The overlap prevents cracks between
    /// neighbours with different planes.
    double overlap_px = 0.02;
    /// Returns upper bounds of the distortion of a part of a surface by the motion in any view. `middle`,
    /// `slope` and `reach` are the arguments of RasterMap::tangent. If empty, nothing moves.
    std::function<MotionStrain(const SheetKey& key, const RasterPoint& middle, const glm::dvec2& slope,
                               const glm::dvec2& reach)>
        motion;

    /// Smaller semi-axis, px, of the CoC ellipse of a shading-tree node whose matrix W (2x2, generalises
    /// 1/z') is `w`.
    [[nodiscard]] double least_blur_px(const Mat2& w) const;
};
[[nodiscard]] PatchLens patch_lens(const FocusGeometry& geometry);

/// Largest error of a reprojection by a nonlinear W, px, at which the records still count as determining the
/// sample of a view. Patches with a larger error are marked as nonlinear (Patch::bent).
inline constexpr double most_bend_px = 0.5;

/// Part of a sheet (one surface within a square of the raster): the pixels [x, x + width) x [y, y + height)
/// of the sheet.
struct Patch {
    std::uint32_t sheet = 0;
    std::uint8_t x = 0, y = 0, width = 0, height = 0;
    bool coarse = false;            ///< blurred over several pixels: uses SheetMesh::coarse
    bool bent = false;              ///< nonlinear W: its error exceeds most_bend_px somewhere
    std::uint8_t depth = 0;         ///< levels of its quadtrees that are used
    std::uint32_t first_plane = 0;  ///< index into PatchMesh::planes
    float back_per_m = 0;           ///< amount, 1/m, by which depth tests reduce the patch's 1/z'
};

/// The affine map of a patch into a view. The point (x, y), in px from the patch's corner, moves to the
/// raster position `from + move * (x, y)`.
struct PatchPlace {
    glm::dmat2 move{1};
    glm::dvec2 from{0};
    glm::dvec3 inverse_z{0};  ///< in the view: value at the patch's corner, slopes along x and y
};

struct PatchMesh {
    const SheetMesh* sheets = nullptr;
    float overlap_px = 0;  ///< PatchLens::overlap_px
    std::vector<Patch> patches;
    /// For each patch, `sheets->values` planes with origin at the patch's corner: 1/z' and, if W is stored,
    /// the entries xx, xy, yx and yy of W.
    std::vector<CellPlane> planes;
    /// For each sheet, the bits (child_bit) of those reflected or transmitted child nodes that are drawn as
    /// part of the sheet. All others are drawn separately (PatchLens::follow_px).
    std::vector<std::uint8_t> follows;

    /// Bits (child_bit) of a texel's reflected and transmitted child nodes that are drawn separately. A texel
    /// is the recorded colour of one quadtree leaf.
    [[nodiscard]] std::uint8_t drawn_children(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::uint8_t children = t.children();
        return children == 0 ? children : static_cast<std::uint8_t>(children & ~follows[t.sheet()]);
    }
    /// Whether an edge crosses the texel's quadtree leaf, in the texel's own node or in a child node that is
    /// drawn as part of it. The colours at the leaf's corners then do not determine the leaf's colour.
    [[nodiscard]] bool unsure(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        return t.unsure() || (t.unsure_below() && (t.children() & follows[t.sheet()]) != 0);
    }
    /// Radiance of the reflected and transmitted child nodes that are drawn as part of the texel (recorded
    /// colour of a quadtree leaf).
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
    /// Radiance of a texel (recorded colour of a quadtree leaf), including the reflected and transmitted
    /// child nodes that are drawn as part of it.
    [[nodiscard]] glm::vec3 light(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::array<float, 3> more = following(texel);
        return {t.r + more[0], t.g + more[1], t.b + more[2]};
    }
    /// Id of the object to which a texel (recorded colour of a quadtree leaf) belongs.
    [[nodiscard]] std::uint32_t id_of(std::uint32_t texel) const {
        return sheets->sheets[sheets->texels[texel].sheet()].key.id;
    }
    [[nodiscard]] const Sheet& sheet(const Patch& p) const { return sheets->sheets[p.sheet]; }
    /// Upper left corner of a patch, raster px.
    [[nodiscard]] glm::dvec2 corner(const Patch& p) const { return {sheet(p).x + p.x, sheet(p).y + p.y}; }
};

/// Divides sheets (surfaces within squares of the raster) into patches that are as large as possible. The
/// position error of a patch's pixels in any view is at most PatchLens::exact_px or 1/50 of the CoC radius,
/// whichever is larger. A patch has at least one raster pixel. The result is deterministic.
///
/// A surface closely behind another one (SheetKey::hidden), such as the cap of an open cylinder, must not
/// show through it. Depth tests therefore move its patches back by Patch::back_per_m, the sum of the largest
/// depth errors of two planes.
[[nodiscard]] PatchMesh cut_patches(const SheetMesh& sheets, const PatchLens& lens);

/// Computes the affine map of a patch (planar part of a surface) into a view. `motion`, linearised at the
/// patch's centre, is applied first, and then the shift by the lens. Returns false if the patch would lie
/// behind the camera.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const RasterMap& motion,
                               const LensShift& lens, PatchPlace& out);

/// The rays from one scene point to all pixels of its CoC. Each of these rays passes through a different lens
/// point.
struct PointRays {
    glm::dvec2 at{0};  ///< the scene point, raster px
    /// The ray to raster position `at + d` passes through the lens point with LensShift::lens_px =
    /// lens_px_per_px * d.
    glm::dmat2 lens_px_per_px{0};
    double inverse_focus_per_m = 0;
};

/// Maps a directly visible patch to the pixels whose `rays` from the scene point the patch blocks. If the
/// patch is nearer than the scene point, it hides the point from all pixels that the mapped patch covers. The
/// map is linearised at the patch's centre. Returns false if the map is singular.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const PointRays& rays,
                               PatchPlace& out);
struct PlacedPatch {
    Patch patch;
    PatchPlace place;
};
/// Appends the maps of those parts of a patch whose inverse depth 1/z' exceeds `nearest_per_m`. `light_per_m`
/// is the scene point's 1/z' and at most `nearest_per_m`. The map is singular at the scene point's depth, so
/// the patch is divided more finely near it: within a part of several pixels, 1/z' - `light_per_m` varies by
/// at most a factor of two.
void place_nearer(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, double light_per_m,
                  double nearest_per_m, std::vector<PlacedPatch>& out);

/// Bounding rectangle of a patch in a view, raster px.
[[nodiscard]] RasterRect covered(const Patch& patch, const PatchPlace& place);

}  // namespace postlens
