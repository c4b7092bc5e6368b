// Divides the recorded surfaces into patches. A patch is so nearly planar that an affine map gives its image
// as seen from another lens point or at another instant.
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

/// Largest effects of motion during the exposure on the image of a patch (planar part of a surface).
/// - `px_m`: displacement of the image, in px, caused by an error of 1 1/m in the patch's inverse depth
/// - `bend_px`: largest error, in px, of the affine map that reprojects the patch
struct MotionStrain {
    double px_m = 0;     ///< RasterTangent::by_depth
    double bend_px = 0;  ///< RasterTangent::bend_px
};

/// The lens that patches are made for.
struct PatchLens {
    double radius_px_m = 0;  ///< CoC radius, px, per 1/m of defocus
    double inverse_focus_per_m = 0;
    double bend_px_m2 = 0;  ///< reprojection error at the lens's rim, px, per 1/m^2 of Record::w_bend
    /// When the lens point changes, a reflection or refraction shifts in the image by another amount than its
    /// mirror or glass. If the two shifts differ by at most this many px for all lens points, the reflection
    /// is drawn as if painted on the mirror. A negative value prevents this.
    double follow_px = default_follow_px;
    static constexpr double default_follow_px = 0.25, all_follow = std::numeric_limits<double>::infinity();
    /// Largest error of position, in px, that a pixel may have when it is reprojected to another lens point
    /// or instant. Surfaces are divided into patches that are small enough for this. The error of blurred
    /// pixels may be larger, because it is less visible.
    double exact_px = 0.1;
    /// Each patch is drawn this many px larger on every side, to prevent cracks between neighbouring patches.
    double overlap_px = 0.02;
    /// Returns the largest effects of motion during the exposure on the image of a part of a surface.
    /// Surfaces are divided into parts that are small enough for these effects. The function is empty if
    /// nothing moves.
    /// - `middle`: centre of the part
    /// - `slope`: gradient of the part's inverse depth, per px
    /// - `reach`: half width and height of the part, in px
    std::function<MotionStrain(const SheetKey& key, const RasterPoint& middle, const glm::dvec2& slope,
                               const glm::dvec2& reach)>
        motion;

    /// Returns how much the lens blurs a surface point: the radius, in px, of its circle of confusion. If a
    /// curved mirror distorts the circle to an ellipse, it is the smaller semi-axis. `w` is the 2x2 matrix
    /// that tells how far the point's image moves with the lens point.
    [[nodiscard]] double least_blur_px(const Mat2& w) const;
};
[[nodiscard]] PatchLens patch_lens(const FocusGeometry& geometry);

/// Limit for an error of reflections and refractions. Their images are assumed to move linearly with the lens
/// point. If the true position differs from the assumed one by more than this many px, the surface counts as
/// insufficiently recorded (Patch::bent).
inline constexpr double most_bend_px = 0.5;

/// A part of a surface that is reprojected as a plane. It has the pixels [x, x + width) x [y, y + height) of
/// a sheet (one surface within a raster square).
struct Patch {
    std::uint32_t sheet = 0;
    std::uint8_t x = 0, y = 0, width = 0, height = 0;
    bool coarse = false;            ///< whether it is blurred over several pixels and uses SheetMesh::coarse
    bool bent = false;              ///< whether the error of a nonlinear W exceeds most_bend_px
    std::uint8_t depth = 0;         ///< number of levels of its quadtrees that are used
    std::uint32_t first_plane = 0;  ///< index into PatchMesh::planes
    float back_per_m = 0;           ///< amount, 1/m, by which depth tests reduce the patch's 1/z'
};

/// The affine map that reprojects a patch (planar part of a surface) into a view. A point (x, y), in px from
/// the patch's corner, appears at `from + move * (x, y)` on the raster.
struct PatchPlace {
    glm::dmat2 move{1};
    glm::dvec2 from{0};
    glm::dvec3 inverse_z{0};  ///< in the view: value at the patch's corner, and slopes along x and y
};

struct PatchMesh {
    const SheetMesh* sheets = nullptr;
    float overlap_px = 0;  ///< PatchLens::overlap_px
    std::vector<Patch> patches;
    /// Linear functions of the position, in px from a patch's corner. The first of each patch is its inverse
    /// depth. Patches seen in mirrors or glass have four more: the entries xx, xy, yx and yy of the matrix
    /// Record::w, which tells how far the image moves with the lens point.
    std::vector<CellPlane> planes;
    /// Each element belongs to one sheet (part of a surface), which may be a mirror or glass. One bit
    /// (child_bit) is set if the sheet's reflection is drawn as if painted on the sheet, because it moves
    /// almost as the sheet does (PatchLens::follow_px). Another bit does the same for the refraction.
    std::vector<std::uint8_t> follows;

    /// Returns which children of the recorded colour number `texel` are drawn as separate surfaces. The
    /// children of a mirror or glass are its reflection and its refraction. The result has one bit
    /// (child_bit) for each child, which is set for those drawn separately.
    [[nodiscard]] std::uint8_t drawn_children(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::uint8_t children = t.children();
        return children == 0 ? children : static_cast<std::uint8_t>(children & ~follows[t.sheet()]);
    }
    /// Returns whether the recorded colour number `texel` is uncertain, because an edge crosses its quadtree
    /// cell. An edge in a reflection or refraction counts only if the reflection or refraction is drawn as if
    /// painted on the surface.
    [[nodiscard]] bool unsure(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        return t.unsure() || (t.unsure_below() && (t.children() & follows[t.sheet()]) != 0);
    }
    /// Returns the radiance of the reflection and refraction that must be added to the recorded colour number
    /// `texel`. They are included if they move almost as the mirror or glass itself does, because they are
    /// then drawn as if painted on it.
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
    /// Returns the radiance of the recorded colour number `texel`. Reflections and refractions that move with
    /// the surface are drawn as if painted on it, so their radiance is included. Those that move differently
    /// are drawn as separate surfaces, so their radiance is not included.
    [[nodiscard]] glm::vec3 light(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::array<float, 3> more = following(texel);
        return {t.r + more[0], t.g + more[1], t.b + more[2]};
    }
    [[nodiscard]] std::uint32_t id_of(std::uint32_t texel) const {
        return sheets->sheets[sheets->texels[texel].sheet()].key.id;
    }
    [[nodiscard]] const Sheet& sheet(const Patch& p) const { return sheets->sheets[p.sheet]; }
    /// Returns the upper left corner of a patch, in raster px.
    [[nodiscard]] glm::dvec2 corner(const Patch& p) const { return {sheet(p).x + p.x, sheet(p).y + p.y}; }
};

/// Divides sheets (surfaces within squares of the raster) into patches, which are reprojected as planes.
/// Patches are as large as possible, and at least one raster pixel. The position error of a larger patch is
/// limited in every view: to PatchLens::exact_px or 1/50 of the circle of confusion's radius, whichever is
/// larger. The result is deterministic.
///
/// A surface closely behind another one (SheetKey::hidden) must not show through it because of depth errors.
/// So depth tests treat its patches as farther away, by Patch::back_per_m. This is the largest depth error of
/// one patch plus that of the patch in front.
[[nodiscard]] PatchMesh cut_patches(const SheetMesh& sheets, const PatchLens& lens);

/// Computes where a patch (planar part of a surface) appears in a view: first applies the object's motion,
/// linearised at the patch's centre, then the image shift by the lens. Returns false if the patch lies behind
/// the camera.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const RasterMap& motion,
                               const LensShift& lens, PatchPlace& out);

/// The rays from one scene point to all pixels of its circle of confusion. Each ray passes through a
/// different lens point.
struct PointRays {
    glm::dvec2 at{0};  ///< the scene point, raster px
    /// Matrix that gives the lens point through which the ray to a pixel passes. It multiplies the offset, in
    /// px, from the scene point's position `at` to the pixel. The result is the lens point in the units of
    /// LensShift::lens_px.
    glm::dmat2 lens_px_per_px{0};
    double inverse_focus_per_m = 0;
};

/// Computes in which pixels a patch (planar part of a surface) blocks the light of a scene point. Each point
/// of the patch blocks the ray to one pixel. `out` receives the map from these points to the pixels,
/// linearised at the patch's centre. Returns false if the map is singular.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const PointRays& rays,
                               PatchPlace& out);
struct PlacedPatch {
    Patch patch;
    PatchPlace place;
};
/// Appends to `out` the parts of a patch (planar part of a surface) whose inverse depth, in 1/m, may exceed
/// `nearest_per_m`, so that they may hide a bright point. `nearest_per_m` must be at least `light_per_m`, the
/// point's own inverse depth.
void place_nearer(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, double light_per_m,
                  double nearest_per_m, std::vector<PlacedPatch>& out);

/// Returns the bounding rectangle of a reprojected patch (planar part of a surface), in raster px.
[[nodiscard]] RasterRect covered(const Patch& patch, const PatchPlace& place);

}  // namespace postlens
