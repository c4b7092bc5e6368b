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
    /// Surfaces that the camera sees in mirrors or through glass; null if there are none.
    const PatchMesh* deeper = nullptr;
};

/// A view: the image that one lens point sees at one instant. Surfaces are recorded only at a few instants.
/// The view is reprojected from one of these, or blended from two of them.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of the colour at this instant if both instants show the same surface
        /// For each group of objects that move alike: its motion on the raster, from the recorded instant to
        /// the instant of the view. Empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether light through this lens point reaches pixel (x, y), for vignetting. Blocked pixels are
    /// black. If empty, no pixel is blocked.
    std::function<bool(int x, int y)> passes;
    // The rays that are traced for this view have this lens point, instant and random seed. See
    // SightLine::lens, SightLine::light_before, SightLine::set and SightLine::view.
    glm::dvec2 lens_point{0};
    double light_before = 0.5;
    std::uint32_t set = 0;
    std::uint32_t number = 0;  ///< SightLine::view

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
    /// Each set draws its views in some squares of the image. Returns whether it draws them in the square
    /// whose upper left pixel is (x, y). If this function is empty, they are drawn in all squares.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds highlights (small bright spots, which the lens blurs over many pixels) to the image. May be null.
    /// Called by several threads.
    const class Lights* lights = nullptr;
    /// Ray tracer for samples that cannot be reprojected from the recorded surfaces, for instance at edges.
    /// If null, no rays are traced.
    const SightRays* rays = nullptr;
    /// Returns what rays replace in the image square that contains pixel (x, y). Default: samples that the
    /// records do not determine (LeftToRays::unsure).
    std::function<LeftToRays(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Optional: selects views whose recorded colour in pixel (x, y) is compared with a traced ray, to
    /// measure its error. Appends their indices to `views`. Requires `rays`.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Optional: selects pixels in which traced rays towards the highlights measure the error of their light.
    /// Returns the probability with which pixel (x, y) was selected, or 0 if it was not. Requires `checked`.
    std::function<double(int x, int y)> aimed;
    /// Index of the output image, in the argument `out` of patch_field, that stores the mean of these views.
    /// Several sets of views (PatchViews) may have the same index, if they draw different squares of the
    /// image.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Objects that move alike form a group. Returns the number of an object's group. Needed only if objects
    /// move or `class_marks` is set.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// Bit mask of each group of objects (motion_class); 0 for a group at rest. PatchPicture::touched stores,
    /// for each pixel, the bits of all groups that may change the pixel. If empty, `touched` is not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// The image is divided into squares, which are drawn in parallel. `piece_px` is the edge of a square in
    /// px: SeenTile::edge (64 px) or a half, a quarter, ... of it.
    int piece_px = SeenTile::edge;
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// Rectangle of pixels in the sample file, in raster px; the end is exclusive. Required if rays are
    /// traced.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Half width and height of the lens, in m, times the film distance in px: the largest |x| and |y| of
    /// LensShift::lens_px. Required if any set has `rays` or `lights`.
    glm::dvec2 lens_reach_px{0};
};

/// The nearest surface in each pixel of an image square, for each view (image for one lens point and
/// instant). If a view blends two recorded instants, only the surface of the first one, PatchView::uses[0],
/// is stored.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1 if nothing is recorded
    std::vector<std::uint32_t> texel;
    /// All directly visible patches (planar parts of surfaces) that any lens point may see in this image
    /// square, nearest first. Null if objects move.
    const PatchMesh* patches = nullptr;
};

/// A highlight is the part of a surface's radiance above a limit. The surface is reprojected without this
/// part. The lens's point spread function distributes this part over the pixels instead.
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
    /// Adds four values per pixel to `light`, in rows of TileViews::row pixels:
    /// - 0 to 2: red, green and blue of the highlights;
    /// - 3: the mean, over all lens points, of the square of the brightest channel.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
    /// A random ray from a pixel through the lens to a highlight.
    struct Line {
        SightLine line;
        NodeIdentity highlight;
        double scale = 0;  ///< radiance times `scale`, averaged over rays, is the light of all highlights
    };
    /// Returns the indices of the highlights whose blurred light may reach a rectangle of the image, in px.
    /// Neighbouring highlights count as one.
    [[nodiscard]] virtual std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const = 0;
    /// Appends up to `count` random rays from pixel (x, y) to those highlights of `sources` that reach it.
    /// Equal seeds give equal rays.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Error of one pixel, measured in some views (images for one lens point and instant). A residual is a traced
/// ray's radiance minus the recorded radiance. It is 0 if the view shows the ray's radiance itself.
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
    /// Returns the error of the highlights' light in this pixel: the mean of the traced rays towards
    /// highlights, minus the light in the image. Returns 0 if no rays were traced.
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
    /// Makes all pixels black and unknown.
    void clear();
    Image image;  ///< mean of all known samples of views; black if no sample is known
    std::vector<float>
        unknown;  ///< per pixel: share of the views, by weight, that see no recorded surface here
    /// Per pixel: fraction of the views, by PatchView::weight, in which a reflection or refraction is
    /// missing. If even its brightest recorded value is darker than the pixel, the view counts less.
    std::vector<float> unknown_below;
    /// Per pixel: fraction of the views, by PatchView::weight, whose colour comes from a traced ray. Empty
    /// without a ray tracer.
    std::vector<float> traced;
    /// Per pixel: measured error of its colour. Empty unless PatchViews::checked is set.
    std::vector<PixelCheck> checks;
    /// Per pixel: the light of highlights in the image, compared with traced rays. Empty without highlights,
    /// or if PatchViews::checked is not set.
    std::vector<HighlightCheck> highlight_checks;
    /// Per pixel: the mean, over all lens points, of the squared radiance of the highlights (fourth value of
    /// Lights::add). Empty if the image has no highlights.
    std::vector<float> light_square;
    /// Per pixel: the bit masks (PatchField::class_marks) of all groups of objects whose motion may change
    /// the pixel's colour, combined. All bits are set where these groups are unknown.
    std::vector<std::uint8_t> touched;
};

/// Computes each image of `out` (field.width x field.height px) as the mean of its views (images for one lens
/// point and instant). Squares of the image in which no view is drawn keep their values. The result is
/// bit-identical for any number of threads.
///
/// The views may be divided among several calls. With rays and moving objects, the result may then differ,
/// because each call estimates the objects' paths from its own views.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
