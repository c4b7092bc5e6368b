// Computes depth of field and motion blur: reprojects the recorded surfaces to many views, and averages
// these. A view is the image that one lens point sees at one instant.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pictures/image.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patches.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// The patches (nearly planar parts of surfaces) of one recorded instant.
struct PatchInstant {
    const PatchMesh* primary = nullptr;
    /// Surfaces that are seen by reflection or transmission; null if there are none.
    const PatchMesh* deeper = nullptr;
};

/// The image that one lens point sees at one instant. It is reprojected from the surfaces recorded at one
/// instant, or blended from two.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of the colour at this instant if both instants show the same surface
        /// Motions on the raster from the time of recording to the time of this view, one per group of
        /// objects that move alike. Empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether light through this lens point reaches pixel (x, y), for vignetting. Blocked pixels are
    /// black. If empty, no pixel is blocked.
    std::function<bool(int x, int y)> passes;
    // Copied into the rays (SightLine) that are traced for this view; `number` becomes SightLine::view.
    glm::dvec2 lens_point{0};
    double light_before = 0.5;
    std::uint32_t set = 0;
    std::uint32_t number = 0;

    [[nodiscard]] bool moves() const {
        return std::any_of(uses.begin(), uses.end(), [](const Use& use) {
            return std::any_of(use.motions.begin(), use.motions.end(),
                               [](const RasterMap& motion) { return !motion.identity(); });
        });
    }
};

/// What rays replace in a square piece of the image.
enum class LeftToRays : std::uint8_t {
    unsure,             ///< samples of views that the records do not determine
    samples,            ///< all samples of views
    samples_and_lights  ///< all samples of views, and also the highlights: no `lights` are added
};

/// A set of views (images for one lens point and instant). Their mean is an image or a part of an image.
struct PatchViews {
    std::vector<PatchView> views;
    /// Returns whether this set draws the image square whose upper left pixel is (x, y). If empty, the set
    /// draws all squares.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds highlights (small bright spots, which the lens blurs over many pixels) to the image. May be null.
    /// Called by several threads.
    const class Lights* lights = nullptr;
    /// Traces the samples whose colour the recorded surfaces do not determine, such as those at edges. If
    /// null, no rays are traced.
    const SightRays* rays = nullptr;
    /// Returns which samples rays replace in the image square that contains pixel (x, y). If empty,
    /// LeftToRays::unsure holds.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Selects views whose recorded colour in pixel (x, y) is compared with a traced ray, to measure the
    /// error. Appends their indices. Optional; needs `rays`.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Returns the probability with which pixel (x, y) was selected for extra rays towards highlights, to
    /// measure their error; 0 if not selected. Optional; needs `checked`.
    std::function<double(int x, int y)> aimed;
    /// Index, in the argument `out` of patch_field, of the image that these views form. Several sets may draw
    /// different squares of one image.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Returns the number of an object's group. All objects of a group move alike. Only called if objects
    /// move or `class_marks` is not empty.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// For each group of objects that move alike, the bits to set in PatchPicture::touched; 0 for groups at
    /// rest. If empty, `touched` is not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// Each task draws an image square with this edge, in px. It must be SeenTile::edge (64 px) divided by a
    /// power of two.
    int piece_px = SeenTile::edge;
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// The recorded raster rectangle (the end is exclusive). If set, unrecorded objects outside it may hide
    /// what a view sees. Required with rays.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Largest |x| and |y| of a lens point, in m, multiplied by the film distance in px. Required with rays
    /// or highlights.
    glm::dvec2 lens_reach_px{0};
};

/// The directly visible surface in each pixel of an image square, for each view (image for one lens point and
/// instant). If a view blends two recorded instants, only the first is stored.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1 if nothing is recorded
    std::vector<std::uint32_t> texel;
    /// Directly visible patches (planar parts of surfaces) that may cover this image square from any lens
    /// point, nearest first. Null if objects move.
    const PatchMesh* patches = nullptr;
};

/// The highlights of an image: radiance above a limit, which is removed from the reprojected surfaces.
/// Instead, the lens's point spread function spreads this light over pixels.
class Lights {
  public:
    Lights() = default;
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;
    Lights(Lights&&) = delete;
    Lights& operator=(Lights&&) = delete;
    virtual ~Lights() = default;
    /// Returns whether light of any highlight reaches a rectangle of the image, in px.
    [[nodiscard]] virtual bool reach(int x, int y, int width, int height) const = 0;
    /// Adds four values per pixel to `light`: the highlights' r, g and b, and the mean square of their
    /// brightest channel over the lens. Rows have TileViews::row pixels.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
    /// A random ray from a pixel to a highlight. The mean of `scale` times the radiance along such rays
    /// estimates the highlights' light in the pixel.
    struct Line {
        SightLine line;
        NodeIdentity highlight;
        double scale = 0;
    };
    /// Returns the indices of the merged highlights whose light may reach a rectangle of the image, in px.
    [[nodiscard]] virtual std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const = 0;
    /// Appends up to `count` random rays from pixel (x, y) to those highlights of `sources` that reach it.
    /// Equal seeds give equal rays.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Compares traced rays with recorded colours in one pixel, to measure the error of the image. A view's
/// residual is the ray's radiance minus the recorded one, or 0 if the image uses the ray.
struct PixelCheck {
    std::uint32_t views = 0;
    std::uint32_t rays = 0;      ///< all rays of the pixel, except HighlightCheck::aimed
    std::array<float, 3> sum{};  ///< sum of the residuals of `views` views, scene-linear
    [[nodiscard]] double mean(std::size_t channel) const {
        return views > 0 ? static_cast<double>(sum[channel]) / views : 0;
    }
};

/// Compares rays with the light of highlights in one pixel, scene-linear.
struct HighlightCheck {
    std::array<float, 3> light{};      ///< in the image
    std::array<float, 3> aimed_sum{};  ///< sum along the rays that are aimed at the highlights
    std::uint32_t aimed = 0;           ///< number of these rays
    float aimed_share = 0;             ///< the result of PatchViews::aimed
    /// Error of the image: the light found by rays towards highlights, minus the light in the image.
    [[nodiscard]] double residual(std::size_t channel) const {
        return aimed > 0
                   ? static_cast<double>(aimed_sum[channel]) / aimed - static_cast<double>(light[channel])
                   : 0;
    }
};

struct PatchPicture {
    PatchPicture() = default;
    /// All pixels black and unknown.
    PatchPicture(int width, int height);
    Image image;  ///< mean of all known samples of views; black if no sample is known
    std::vector<float>
        unknown;  ///< per pixel: share of the views, by weight, that see no recorded surface here
    /// Per pixel: weighted fraction of the views in which a reflection or refraction was not recorded.
    /// Reduced if these surfaces are dark in the whole tile.
    std::vector<float> unknown_below;
    /// Per pixel: weighted fraction of the views whose colour comes from a traced ray. Empty without a ray
    /// tracer.
    std::vector<float> traced;
    /// Per pixel: differences between traced rays and recorded colours, to measure the error. Empty unless
    /// PatchViews::checked is set.
    std::vector<PixelCheck> checks;
    /// Per pixel: differences between traced and computed highlights. Empty without highlights or
    /// PatchViews::checked.
    std::vector<HighlightCheck> highlight_checks;
    /// Per pixel: mean squared radiance of the highlights over the lens (fourth value of Lights::add). Empty
    /// without highlights.
    std::vector<float> light_square;
    /// Per pixel: bits (PatchField::class_marks) of the moving objects that may change it. All bits are set
    /// where a view sees something unrecorded.
    std::vector<std::uint8_t> touched;
};

/// Draws each image of `out` (field.width x field.height px) as the mean of views, i.e. images for one lens
/// point and instant. Image squares that no set of views draws keep their values. The result is bit-identical
/// for any number of threads.
///
/// Several calls give the same result as one, unless there are rays and moving objects. Then, rays may
/// replace more surfaces if a call has more views.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
