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

/// A view: the image that one lens point sees at one instant. The surfaces are recorded only at a few
/// instants. Therefore, the view is reprojected from one recorded instant, or blended from two, between which
/// its instant lies.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of the colour at this instant if both instants show the same surface
        /// Motions of the objects, as maps on the raster. Objects that move alike form a group, and the
        /// vector has one map for each group. A map leads from the position at the recorded instant `instant`
        /// to the position at the instant of this view. The vector is empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether light through the lens point of this view reaches pixel (x, y). Vignetting blocks the
    /// other pixels, so they are black in this view. If the function is empty, no pixel is blocked.
    std::function<bool(int x, int y)> passes;
    // Data of the rays that are traced for this view, because they replace some of its colours. `lens_point`
    // is the point of the lens through which the rays pass. `light_before` is the fraction of the shutter's
    // light before their instant. `set` and `number` number the view, and determine the random values of its
    // rays. See the fields of SightLine.
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

/// A set of views (images for one lens point and instant), with the settings that they share. The mean of the
/// views is an image, or a part of an image if the set is used only in some squares.
struct PatchViews {
    std::vector<PatchView> views;
    /// Squares of the image may use different sets of views. Returns whether the views of this set are drawn
    /// in the square of `width` x `height` px whose upper left pixel is (x, y). If the function is empty,
    /// they are drawn in all squares.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds highlights to the image: small bright spots of surfaces, which the lens blurs over many pixels.
    /// Their light is not part of the views' recorded colours. Null if there are none. Several threads call
    /// its functions.
    const class Lights* lights = nullptr;
    /// Ray tracer that computes those samples of the views that cannot be reprojected from the recorded
    /// surfaces, for instance at edges. If it is null, no rays are traced.
    const SightRays* rays = nullptr;
    /// Returns which samples rays replace in the square of the image that contains pixel (x, y). If the
    /// function is empty, rays replace only the samples that the recorded surfaces do not determine, for
    /// instance at edges (LeftToRays::unsure).
    std::function<LeftToRays(int x, int y)> left_to_rays;
    /// Optional: returns how many rays per view are traced in pixel (x, y) in addition to the view samples.
    /// If the function is empty, none are. Requires `rays`, and views without vignetting.
    std::function<int(int x, int y)> extra_rays;
    /// The additional rays of a pixel, without its position: extra_lines[n][i] is number n of view i. Those
    /// with the same n are an independent set of lens points, positions in the pixel and instants.
    std::vector<std::vector<SightLine>> extra_lines;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Optional: selects views in which the recorded colour of pixel (x, y) is compared with a traced ray, to
    /// measure the error of this colour. The indices of these views in the vector `views` of this set are
    /// appended to the argument `views`. Requires `rays`.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Optional: selects some pixels at random, in which the error of the highlights' light is measured. For
    /// this, rays are traced from these pixels towards the highlights, and are compared with the light in the
    /// image. Returns the probability with which pixel (x, y) was selected, or 0 if it was not selected.
    /// Requires `checked`.
    std::function<double(int x, int y)> aimed;
    /// Index of the image in the argument `out` of patch_field to which this set belongs. The image stores
    /// the mean of the set's views. Several sets may have the same index if each of them draws other squares
    /// of this image (`wanted`).
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Returns the number of the group to which object `id` belongs. Objects that move alike form a group, so
    /// they share a map of their motion. The function is needed only if objects move, or if `class_marks` is
    /// set.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// Bit mask of each group of objects, with the index that `motion_class` returns. It is 0 for a group
    /// that does not move. The masks tell in the result where motion matters: for each pixel,
    /// PatchPicture::touched combines the masks of all groups that may change the pixel. If the vector is
    /// empty, `touched` is not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// Width, in px, of the squares (pieces) into which the image is divided. They are drawn in parallel. The
    /// width is SeenTile::edge (64 px) or a half, a quarter, ... of it.
    int piece_px = SeenTile::edge;
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// Rectangle of pixels in the sample file, in raster px; the end is exclusive. Required if rays are
    /// traced.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Half width and half height of the lens, in m, times film distance / pixel pitch, in px m. These are
    /// the largest |x| and |y| that LensShift::lens_px, the lens point of a view, can have. Required if any
    /// set has `rays` or `lights`. For instance, the light of a highlight may reach a pixel through lens
    /// points that no view has.
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
    /// the image, sorted from the nearest on. They tell which surfaces may hide a highlight. Null if objects
    /// move.
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
    /// Adds the blurred light of the highlights in a tile (square of the image) to `light`. It has four
    /// values per pixel and rows of TileViews::row pixels. `views` contains the surfaces that may hide
    /// highlights.
    /// - 0 to 2: red, green and blue radiance of the highlights;
    /// - 3: the square of the brightest channel of this radiance as seen from one lens point, averaged over
    ///   all lens points.
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
    /// Appends to `lines` random rays from pixel (x, y) through the lens to highlights. Only those highlights
    /// of `sources` (indices from `reaching`) whose light reaches the pixel are used. At most `count` rays
    /// are appended. Equal values of `seed` give equal rays.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Error of the recorded colours in one pixel, measured in some views (images for one lens point and
/// instant). In each of these views, a ray is traced, and the residual is its radiance minus the radiance
/// that the view shows. If the view already shows the radiance of a ray instead of a recorded one, the
/// residual is 0.
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
    /// Returns the error of the light that highlights (small bright spots, blurred by the lens) add to this
    /// pixel. Rays traced from the pixel towards the highlights give the true light. The error is the mean of
    /// these rays minus the light in the image. Returns 0 if no rays were traced.
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
    /// For each pixel: the fraction of the views (images for one lens point and instant) in which a
    /// reflection or refraction is missing. Each view counts by its PatchView::weight. A missing reflection
    /// matters less if it is dark. Therefore, if its brightest recorded value b is darker than the pixel's
    /// brightness p, the fraction is multiplied by b / p.
    std::vector<float> unknown_below;
    /// For each pixel: the fraction of the views (images for one lens point and instant) in which its colour
    /// comes from a traced ray instead of the records. Each view counts by its PatchView::weight. Empty if
    /// there is no ray tracer.
    std::vector<float> traced;
    /// Per pixel: measured error of its colour. Empty unless PatchViews::checked is set.
    std::vector<PixelCheck> checks;
    /// For each pixel: the light that highlights (small bright spots, blurred by the lens) add to the image,
    /// and the mean of traced rays with which it is compared to measure its error. Empty if there are no
    /// highlights, or if no pixels are selected for measuring errors because PatchViews::checked is empty.
    std::vector<HighlightCheck> highlight_checks;
    /// For each pixel: the mean square of the highlights' radiance, from which their noise is predicted if
    /// rays compute their light. Each lens point may see a different radiance, of which the brightest channel
    /// is squared and averaged over all lens points. It is the fourth value of Lights::add. Empty if the
    /// image has no highlights.
    std::vector<float> light_square;
    /// For each pixel: which groups of moving objects may change its colour. Each group has a bit mask
    /// (PatchField::class_marks), and the masks of all these groups are combined by a bitwise or. All bits
    /// are set in a pixel in which these groups are unknown, because a view shows no recorded surface there.
    std::vector<std::uint8_t> touched;
};

/// Computes images with depth of field and motion blur. Each image of `out` (field.width x field.height px)
/// is the mean of its views (images for one lens point and instant). Squares of the image in which no view is
/// drawn keep their values. The result is bit-identical for any number of threads.
///
/// The views may be divided among several calls. With rays and moving objects, the result may then differ,
/// because each call estimates the objects' paths from its own views.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
