// Sheets cut into patches whose depth is a plane, as nearly as a lens can tell: each moves by an affine map.
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

/// The most that any of some motions does.
struct MotionStrain {
    double px_m = 0;     ///< RasterTangent::by_depth
    double bend_px = 0;  ///< RasterTangent::bend_px
};

/// A lens for which patches are made: what it can tell apart, and what it blurs.
struct PatchLens {
    double radius_px_m = 0;  ///< gain times the lens's radius: px by which 1/m out of focus moves its rim
    double inverse_focus_per_m = 0;
    double bend_px_m2 = 0;  ///< px by which a W.bend of 1/m^2 misses at the rim
    /// px at the rim by which what is seen in a mirror or in glass may part from it and yet be taken for its
    /// own light; less than 0: none is; all_follow: all is.
    double follow_px = default_follow_px;
    static constexpr double default_follow_px = 0.25, all_follow = std::numeric_limits<double>::infinity();
    double exact_px = 0.1;  ///< by which a patch may miss a cell's place in a view; more where it is blurred
    /// px by which a patch reaches beyond its sides, so that neighbours whose planes differ leave no crack.
    double overlap_px = 0.02;
    /// What the motions of all views do to a part of a sheet; none: nothing moves. `middle`, `slope` and
    /// `reach`: as RasterMap::tangent.
    std::function<MotionStrain(const SheetKey& key, const RasterPoint& middle, const glm::dvec2& slope,
                               const glm::dvec2& reach)>
        motion;

    /// Least half width of the blur of what has this W, px.
    [[nodiscard]] double least_blur_px(const Mat2& w) const;
};
[[nodiscard]] PatchLens patch_lens(const FocusGeometry& geometry);

/// What W may be off by where nothing but W says that something is seen.
inline constexpr double most_bend_px = 0.5;

/// Cells [x, x + width) x [y, y + height) of a sheet.
struct Patch {
    std::uint32_t sheet = 0;
    std::uint8_t x = 0, y = 0, width = 0, height = 0;
    bool coarse = false;            ///< blurred over so many pixels that each cell may be one even square
    bool bent = false;              ///< somewhere W is off by more than most_bend_px
    std::uint8_t depth = 0;         ///< levels of the quadtrees that matter
    std::uint32_t first_plane = 0;  ///< `values` of PatchMesh::planes
    float back_per_m = 0;  ///< by so much of 1/z' it is taken to be farther where depths are compared
};

/// How a patch comes to lie: raster px `from + move * (x, y)` of what was recorded at (x, y) px from the
/// patch's corner.
struct PatchPlace {
    glm::dmat2 move{1};
    glm::dvec2 from{0};
    glm::dvec3 inverse_z{0};  ///< there: value, and its slopes by x and y
};

struct PatchMesh {
    const SheetMesh* sheets = nullptr;
    float overlap_px = 0;  ///< PatchLens::overlap_px
    std::vector<Patch> patches;
    /// By patch, `sheets->values` each, around the patch's corner: 1/z', xx, xy, yx, yy.
    std::vector<CellPlane> planes;
    /// By sheet: child_bit of the bounces whose light moves with the sheet, as nearly as a lens can tell.
    std::vector<std::uint8_t> follows;

    /// Of a texel of `sheets`: child_bit of the bounces that are to be drawn for themselves.
    [[nodiscard]] std::uint8_t drawn_children(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::uint8_t children = t.children();
        return children == 0 ? children : static_cast<std::uint8_t>(children & ~follows[t.sheet()]);
    }
    /// Whether an edge cuts what a texel was made of, or the light that moves with it.
    [[nodiscard]] bool unsure(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        return t.unsure() || (t.unsure_below() && (t.children() & follows[t.sheet()]) != 0);
    }
    /// The light that moves with a texel of `sheets`, beside its own.
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
    /// Its own light and that.
    [[nodiscard]] glm::vec3 light(std::uint32_t texel) const {
        const Texel& t = sheets->texels[texel];
        const std::array<float, 3> more = following(texel);
        return {t.r + more[0], t.g + more[1], t.b + more[2]};
    }
    /// Of what has a texel of `sheets`.
    [[nodiscard]] std::uint32_t id_of(std::uint32_t texel) const {
        return sheets->sheets[sheets->texels[texel].sheet()].key.id;
    }
    [[nodiscard]] const Sheet& sheet(const Patch& p) const { return sheets->sheets[p.sheet]; }
    /// Raster px of its corner.
    [[nodiscard]] glm::dvec2 corner(const Patch& p) const { return {sheet(p).x + p.x, sheet(p).y + p.y}; }
};

/// What was closely hidden where it was recorded counts as farther than its plane by what two planes may be
/// off together (Patch::back_per_m): closely behind another surface, as the cap inside the end of an open
/// cylinder, it must not show through that. Where the lens sees past what hides it, nothing is compared.
/// Patches as large as every cell is where its own depth puts it, within PatchLens::exact_px, for every view,
/// or within a fiftieth of the blur at the lens's rim; at least a cell each. Deterministic.
[[nodiscard]] PatchMesh cut_patches(const SheetMesh& sheets, const PatchLens& lens);

/// Where a patch lies as `motion` (to first order around the patch's middle) and then the lens move it.
/// False where it would lie behind the camera.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const RasterMap& motion,
                               const LensShift& lens, PatchPlace& out);

/// All light of a point: what of it reaches a pixel has come through one point of the lens, another for each.
struct PointRays {
    glm::dvec2 at{0};  ///< raster px of the point
    glm::dmat2 lens_px_per_px{
        0};  ///< the light that reaches `at + d` has come through LensShift::lens_px = this * d
    double inverse_focus_per_m = 0;
};

/// Where a primary patch lies for an eye that looks, at each pixel, through the lens's point that the light
/// of `rays` comes through: what is nearer than the light there keeps it from the pixel. To first order
/// around the patch's middle. False where it has no such place.
[[nodiscard]] bool place_patch(const PatchMesh& mesh, const Patch& patch, const PointRays& rays,
                               PatchPlace& out);
struct PlacedPatch {
    Patch patch;
    PatchPlace place;
};
/// Appends what a patch has nearer than `nearest_per_m`, where the light is at `light_per_m` or farther, both
/// as 1/z': in parts that are small enough for the first order, which fails near the light's own depth. No
/// part is at one corner more than twice as far before the light as at another, but single cells.
void place_nearer(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, double light_per_m,
                  double nearest_per_m, std::vector<PlacedPatch>& out);

/// The rectangle that it then covers, raster px.
[[nodiscard]] RasterRect covered(const Patch& patch, const PatchPlace& place);

}  // namespace postlens
