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
    /// Surfaces that are seen in mirrors or through glass; null if there are none.
    const PatchMesh* deeper = nullptr;
};

/// A view: the image that one lens point sees at one instant. It is made by reprojection of the recorded
/// surfaces. If its instant lies between two recorded ones, the view is a blend of two reprojections.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of the colour at this instant if both instants show the same surface
        /// Motions of the objects from the recorded instant, number `instant`, to that of the view. Objects
        /// that move alike form a group, and the vector has one element per group: a map between the raster
        /// positions at these instants. Empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether light through the lens point of this view reaches pixel (x, y). Vignetting blocks the
    /// other pixels, so they are black in this view. If the function is empty, no pixel is blocked.
    std::function<bool(int x, int y)> passes;
    // Rays can replace some of the view's colours. These four fields describe the rays, as in SightLine.
    // `light_before` is the fraction of the exposure's light that arrives before the instant of the view.
    // `set` and `number` are the seed of the rays' random values.
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

/// A set of views (images for one lens point and instant), with their common settings. The views are averaged
/// to make an image. Different parts of an image may use different sets, for example with more or fewer views
/// (`wanted`).
struct PatchViews {
    std::vector<PatchView> views;
    /// Returns whether the views of this set are drawn in a square of the image, which has `width` x `height`
    /// px and the upper left pixel (x, y). If the function is empty, they are drawn in the whole image.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// The highlights, which are small bright spots of surfaces. The lens blurs them over many pixels, so
    /// they are not contained in the views, but are added to the image by this object. Null if there are
    /// none. Several threads call its functions.
    const class Lights* lights = nullptr;
    /// Ray tracer that computes those samples of the views that cannot be reprojected from the recorded
    /// surfaces, for instance at edges. If it is null, no rays are traced.
    const SightRays* rays = nullptr;
    /// Tells which recorded colours of pixel (x, y) are replaced by the colours of traced rays. The result
    /// must be the same in the whole square piece (PatchField::piece_px) that contains the pixel. If the
    /// function is empty, the result is LeftToRays::unsure.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    /// Optional: returns how many rays per view are traced in pixel (x, y) in addition to the view samples.
    /// If the function is empty, none are. Requires `rays`, and views without vignetting.
    std::function<int(int x, int y)> extra_rays;
    /// The additional rays of a pixel, without its position: extra_lines[n][i] is number n of view i. Those
    /// with the same n are an independent set of lens points, positions in the pixel and instants.
    std::vector<std::vector<SightLine>> extra_lines;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Optional function of the caller. It chooses the views in which a ray checks the recorded colour of
    /// pixel (x, y), to measure the error of this colour. It appends the indices of these views in
    /// PatchViews::views to its argument `views`. Requires `rays`.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Optional: chooses random pixels in which rays measure the error of the highlights, which are bright
    /// spots that the lens blurs over many pixels. Returns the probability with which pixel (x, y) was
    /// chosen, or 0 if it was not chosen. Requires `checked`.
    std::function<double(int x, int y)> aimed;
    /// Index of the image to which the views of this set contribute, in the argument `out` of the function
    /// patch_field. The image is the mean of the views. Several sets may have the same index if they are
    /// drawn in different squares of this image (`wanted`).
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Returns the number of the group to which the object `id` belongs. All objects of a group move alike,
    /// so one map (PatchView::Use::motions) describes their motion on the raster. Needed only if objects
    /// move, or if `class_marks` is set.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// Bit masks that tell which moving objects may change a pixel. There is one for each group of objects
    /// that move alike (`motion_class`); it is 0 if the group does not move. PatchPicture::touched combines
    /// them. If `class_marks` is empty, `touched` is not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// Width, in px, of the squares (pieces) into which the image is divided. They are drawn in parallel. The
    /// width is SeenTile::edge (64 px) or a half, a quarter, ... of it.
    int piece_px = SeenTile::edge;
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// The rectangle of pixels that the sample file contains, in raster px, including the overscan around the
    /// image. `recorded_end` is exclusive. Required if the views have rays (PatchViews::rays).
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Half width and half height of the lens, in m, times film distance / pixel pitch, so the unit is px m,
    /// as that of LensShift::lens_px. No |x| or |y| of a lens point may be larger. Required if any set of
    /// views has `rays` or `lights`.
    glm::dvec2 lens_reach_px{0};
};

/// Stores which surface is nearest in each pixel of a square of the image, for each view (image for one lens
/// point and instant). A view may be blended from two recorded instants. Then only the surface of the first
/// instant, PatchView::uses[0], is stored.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1 if nothing is recorded
    std::vector<std::uint32_t> texel;
    /// All directly visible patches (planar parts of surfaces) that any lens point may see in this square of
    /// the image, sorted from the nearest on. They are used to determine which surfaces hide a highlight.
    /// Null if objects move.
    const PatchMesh* patches = nullptr;
};

/// Draws highlights: the part of a surface's radiance above a limit. The lens's point spread function
/// distributes it over the pixels, whereas the part up to the limit is reprojected to each view.
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
    /// Adds the blurred light of the highlights in a tile (square of the image) to `light`. `views` contains
    /// the surfaces that may hide highlights. The array `light` has rows of TileViews::row pixels, and four
    /// values per pixel:
    /// - 0 to 2: red, green and blue radiance of the highlights
    /// - 3: the mean over all lens points of the squared radiance (brightest channel) seen from one lens
    ///   point
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
    /// A ray that measures the light of a highlight (bright spot that the lens blurs over many pixels). It
    /// starts at a pixel, and passes through a random lens point to the highlight.
    struct Line {
        SightLine line;
        NodeIdentity highlight;
        double scale = 0;  ///< radiance times `scale`, averaged over rays, is the light of all highlights
    };
    /// Returns the indices of the highlights whose blurred light may reach a rectangle of the image, in px.
    /// Neighbouring highlights count as one.
    [[nodiscard]] virtual std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const = 0;
    /// Appends to `lines` random rays from pixel (x, y) through the lens to highlights. Only those highlights
    /// of `sources` (indices from `reaching`) whose light reaches the pixel are used. At most `count` rays
    /// are appended. Equal values of `seed` give equal rays.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Error of the recorded colours in one pixel, measured in some views (images for one lens point and
/// instant). In each of them, a ray is traced, and the residual is its radiance minus the radiance that the
/// view shows. If the view already shows the radiance of a ray instead of a recorded one, no further ray is
/// traced, and the residual is 0.
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
    /// Returns the error of the light that the highlights add to this pixel. It is the mean of the rays aimed
    /// at the highlights minus the light in the image, or 0 if no rays were traced.
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
    /// For each pixel: the weighted fraction of the views (images for one lens point and instant) in which it
    /// lacks a reflection or refraction that is not recorded. If the brightest recorded value b of the
    /// reflection is less than the pixel's brightness p, the fraction is multiplied by b / p.
    std::vector<float> unknown_below;
    /// For each pixel: the fraction of the views in which the pixel's colour was computed by a traced ray,
    /// and not reprojected from recorded surfaces. Each view is weighted by PatchView::weight. Empty if there
    /// is no ray tracer.
    /// Additional rays (PatchViews::extra_rays) do not count.
    std::vector<float> traced;
    /// For each pixel: the error of its recorded colours, measured by traced rays in some of its views. Empty
    /// unless PatchViews::checked, which chooses the views, is set.
    std::vector<PixelCheck> checks;
    /// For each pixel: the light that the highlights (bright spots that the lens blurs over many pixels) add
    /// to the image, and the true light, measured by traced rays. Empty if there are no highlights, or if
    /// PatchViews::checked is empty.
    std::vector<HighlightCheck> highlight_checks;
    /// For each pixel: the mean square of the highlights' radiance, which is the fourth value of Lights::add.
    /// It predicts the noise if rays through random lens points computed this light. Empty if the image has
    /// no highlights.
    std::vector<float> light_square;
    /// For each pixel: which moving objects may change its colour, as the bitwise or of their bit masks
    /// (PatchField::class_marks). All bits are set if a view shows no recorded surface in the pixel, because
    /// any object may appear there.
    std::vector<std::uint8_t> touched;
};

/// Computes images with depth of field and motion blur. Each image of `out` (field.width x field.height px)
/// is the mean of its views (images for one lens point and instant). Squares of the image in which no view is
/// drawn (PatchViews::wanted, PatchField::wanted_marks) keep their values. The result is bit-identical for
/// any number of threads.
///
/// The views may be divided among several calls. If objects move and rays replace colours (PatchViews::rays),
/// the result may then differ, because each call estimates the objects' paths from its own views.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
