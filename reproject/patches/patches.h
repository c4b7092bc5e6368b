// Divides the recorded surfaces into patches. A patch is so nearly planar that an affine map can reproject it
// to a view.
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
    /// A reflected or transmitted surface is drawn as part of the surface that shows it if, for all lens
    /// points, the displacements of the two images differ by at most this many px. All other such surfaces
    /// are drawn separately. A negative value separates all of them, and all_follow none.
    double follow_px = default_follow_px;
    static constexpr double default_follow_px = 0.25, all_follow = std::numeric_limits<double>::infinity();
    /// Largest error, in px, of the position of a cell (pixel of a surface) in a view. Blurred cells may have
    /// a larger error.
    double exact_px = 0.1;
    /// A patch is drawn this many px beyond its sides, to prevent cracks between neighbouring patches.
    double overlap_px = 0.02;
    /// Returns upper bounds of the distortion of a part of a surface by the motions in all views. The part is
    /// given by its centre, its gradient of 1/z', and half its size (RasterMap::tangent). If the function is
    /// empty, nothing moves.
    std::function<MotionStrain(const SheetKey& key, const RasterPoint& middle, const glm::dvec2& slope,
                               const glm::dvec2& reach)>
        motion;

    /// Returns the radius, in px, of the circle of confusion of a shading-tree node. The matrix `w` describes
    /// how the node's image moves with the lens point. If `w` is not isotropic, the circle is an ellipse,
    /// whose smaller semi-axis is returned.
    [[nodiscard]] double least_blur_px(const Mat2& w) const;
};
[[nodiscard]] PatchLens patch_lens(const FocusGeometry& geometry);

/// Largest accepted error, in px, of the assumption that a reflected or refracted image moves linearly with
/// the lens point. Patches with a larger error are marked (Patch::bent), and the records count as
/// insufficient for their samples.
inline constexpr double most_bend_px = 0.5;

/// A part of a sheet: the pixels [x, x + width) x [y, y + height) of the sheet. A sheet is one surface within
/// a square of the raster.
struct Patch {
    std::uint32_t sheet = 0;
    std::uint8_t x = 0, y = 0, width = 0, height = 0;
    bool coarse = false;            ///< whether it is blurred over several pixels and uses SheetMesh::coarse
    bool bent = false;              ///< whether the error of a nonlinear W exceeds most_bend_px
    std::uint8_t depth = 0;         ///< number of levels of its quadtrees that are used
    std::uint32_t first_plane = 0;  ///< index into PatchMesh::planes
    float back_per_m = 0;           ///< amount, 1/m, by which depth tests reduce the patch's 1/z'
};

/// The affine map of a patch into a view. It maps the point (x, y), in px from the patch's corner, to the
/// raster position `from + move * (x, y)`.
struct PatchPlace {
    glm::dmat2 move{1};
    glm::dvec2 from{0};
    glm::dvec3 inverse_z{0};  ///< in the view: value at the patch's corner, and slopes along x and y
};

struct PatchMesh {
    const SheetMesh* sheets = nullptr;
    float overlap_px = 0;  ///< PatchLens::overlap_px
    std::vector<Patch> patches;
    /// Each patch has `sheets->values` linear functions, with the patch's corner as the origin. The first one
    /// is 1/z'. If the matrix W (motion of the image with the lens point) is stored, its entries xx, xy, yx
    /// and yy follow.
    std::vector<CellPlane> planes;
    /// For each sheet (part of a surface), the bits (child_bit) of those reflections and refractions that are
    /// drawn as part of the sheet. All others are drawn separately (PatchLens::follow_px).
    std::vector<std::uint8_t> follows;

    /// Returns the bits (child_bit) of the reflections and refractions that are drawn separately at a texel
    /// (recorded colour of one quadtree leaf).
    [[nodiscard]] std::uint8_t drawn_children(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::uint8_t children = t.children();
        return children == 0 ? children : static_cast<std::uint8_t>(children & ~follows[t.sheet()]);
    }
    /// Returns whether an edge crosses a texel's quadtree leaf. The recorded colours at the leaf's corners
    /// then do not determine the colour within the leaf. The edge may be in the surface itself, or in a
    /// reflection or refraction that is drawn as part of it.
    [[nodiscard]] bool unsure(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        return t.unsure() || (t.unsure_below() && (t.children() & follows[t.sheet()]) != 0);
    }
    /// Returns the radiance of the reflections and refractions that are drawn as part of the texel (recorded
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
    /// Returns the radiance of a texel (recorded colour of a quadtree leaf), including the reflections and
    /// refractions that are drawn as part of it.
    [[nodiscard]] glm::vec3 light(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::array<float, 3> more = following(texel);
        return {t.r + more[0], t.g + more[1], t.b + more[2]};
    }
    /// Returns the id of the object to which a texel (recorded colour of a quadtree leaf) belongs.
    [[nodiscard]] std::uint32_t id_of(std::uint32_t texel) const {
        return sheets->sheets[sheets->texels[texel].sheet()].key.id;
    }
    [[nodiscard]] const Sheet& sheet(const Patch& p) const { return sheets->sheets[p.sheet]; }
    /// Returns the upper left corner of a patch, in raster px.
    [[nodiscard]] glm::dvec2 corner(const Patch& p) const { return {sheet(p).x + p.x, sheet(p).y + p.y}; }
};

/// Divides sheets (surfaces within squares of the raster) into patches that are as large as possible. In any
/// view, the position error of a patch's pixels is at most PatchLens::exact_px or 1/50 of the radius of the
/// circle of confusion, whichever is larger. The smallest patch is one raster pixel. The result is
/// deterministic.
///
/// A surface closely behind another one (SheetKey::hidden) must not show through it. Depth tests therefore
/// move the patches of the rear surface back by Patch::back_per_m. This distance is the sum of the largest
/// depth errors of two planes.
[[nodiscard]] PatchMesh cut_patches(const SheetMesh& sheets, const PatchLens& lens);

/// Computes the affine map of a patch into a view. The map first applies `motion`, linearised at the patch's
/// centre, and then the shift by the lens. Returns false if the patch would lie behind the camera.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const RasterMap& motion,
                               const LensShift& lens, PatchPlace& out);

/// The rays from one scene point to all pixels of its circle of confusion. Each ray passes through a
/// different lens point.
struct PointRays {
    glm::dvec2 at{0};  ///< the scene point, raster px
    /// The ray to the raster position `at + d` passes through the lens point `lens_px_per_px * d`, in m times
    /// film distance / pixel pitch (px m), as LensShift::lens_px.
    glm::dmat2 lens_px_per_px{0};
    double inverse_focus_per_m = 0;
};

/// Computes the map from a directly visible patch to the raster along the rays of the scene point: a point of
/// the patch maps to the raster position whose ray passes through it. A patch nearer than the scene point
/// hides the scene point there. The map is linearised at the patch's centre. Returns false if the map is
/// singular.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const PointRays& rays,
                               PatchPlace& out);
struct PlacedPatch {
    Patch patch;
    PatchPlace place;
};
/// Divides a patch, and appends those parts that are nearer than 1 / `nearest_per_m`, with their maps to the
/// raster. These parts may hide the scene point, whose inverse depth `light_per_m` is at most
/// `nearest_per_m`. Near the depth of the scene point, where the map is singular, parts are smaller: within a
/// part, 1/z' - `light_per_m` varies by at most a factor of two, unless the part is a single pixel.
void place_nearer(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, double light_per_m,
                  double nearest_per_m, std::vector<PlacedPatch>& out);

/// Returns the bounding rectangle of a patch in a view, in raster px.
[[nodiscard]] RasterRect covered(const Patch& patch, const PatchPlace& place);

}  // namespace postlens
