// Reprojects the recorded surfaces to many views, each from its own lens point and at its own instant, and
// averages the views.
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
    const PatchMesh* deeper = nullptr;  ///< patches of reflected and transmitted nodes; null: there are none
};

/// One view: up to two recorded instants, each reprojected to the view's lens point and instant. The two
/// reprojections are blended.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of this instant's colour where both instants show the same surface
        /// Motion from the recorded instant to the view's instant, for each class of objects that move alike.
        /// Empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether the lens transmits light to the pixel (x, y) of the image. Pixels without light are
    /// black. An empty function means that all pixels get light.
    std::function<bool(int x, int y)> passes;
    // If the set of views has rays, these values are copied to each ray (SightLine). `number` becomes
    // SightLine::view.
    glm::dvec2 lens_point{0};
    double light_before = 0.5;
    std::uint32_t set = 0;
    std::uint32_t number = 0;

    /// Whether something moves between the recorded instants and the view's.
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
    samples_and_lights  ///< all samples of views and the highlights: no `lights` are added
};

/// A set of views. Their mean is an image, or some square pieces of an image.
struct PatchViews {
    std::vector<PatchView> views;
    /// Returns whether this set of views draws a piece (a square of the image, with edge
    /// PatchField::piece_px). An empty function means that it draws all pieces. Pieces that no set draws stay
    /// black and unknown.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds highlights to a square piece of the image, depending on the surfaces that every view sees in it.
    /// Several threads call it at the same time. Null if there are no highlights.
    const class Lights* lights = nullptr;
    /// Traces a ray for each view sample (one view's sample in one pixel) whose colour the records do not
    /// determine. If null, these samples keep their recorded colours.
    const SightRays* rays = nullptr;
    /// Only with rays: returns what rays replace in the piece (square of the image) that contains the pixel
    /// (x, y). If empty, LeftToRays::unsure.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Only with rays: appends the indices of the views whose samples in the pixel (x, y) are compared with a
    /// ray. The results are stored in PatchPicture::checks; the image does not change. If empty, no samples
    /// are compared.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Only with `checked`: whether rays are aimed at the highlights of the pixel (x, y). Returns the
    /// probability with which the pixel was chosen, or 0 if it was not. If empty, none is chosen.
    std::function<double(int x, int y)> aimed;
    /// Index of the image that this set of views draws. Sets of one image must draw different square pieces
    /// of it.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Returns the class of an object. Objects of one class move alike. Only called if objects move or
    /// `class_marks` is not empty.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// For each class of objects that move alike, the bits that are set in PatchPicture::touched where a view
    /// sees such an object. 0 for a class that does not move in any view. If the list is empty, `touched` is
    /// not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// Edge of a piece, px: SeenTile::edge divided by a power of two.
    int piece_px = SeenTile::edge;
    /// The sets of views. They share the search for the patches (planar parts of surfaces) of a tile.
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// The rectangle of raster pixels that have records, from `recorded_begin` to before `recorded_end`.
    /// Where something moves, a view does not know what it sees behind a surface that may continue beyond
    /// this rectangle. If both are equal, surfaces are assumed to end at the border. Needed for sets with
    /// rays.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Largest distance of a lens point from the lens's centre, in units of LensShift::lens_px. The search
    /// for patches then covers all these lens points, not only those of the views. Set it if `lights` use
    /// TileViews::patches. Also set it with rays: the samples that rays replace then do not depend on which
    /// views are drawn.
    glm::dvec2 lens_reach_px{0};
};

/// The directly visible surfaces that every view sees in a piece of the image. They come from the view's
/// first recorded instant.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1: nothing recorded
    std::vector<std::uint32_t> texel;
    /// The directly visible patches (planar parts of surfaces) that any lens point may see here, nearest
    /// first. Null if objects move.
    const PatchMesh* patches = nullptr;
};

/// Highlights: bright radiance that was removed from the reprojected surfaces. Each highlight is spread over
/// the image by its impulse response.
class Lights {
  public:
    Lights() = default;
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;
    Lights(Lights&&) = delete;
    Lights& operator=(Lights&&) = delete;
    virtual ~Lights() = default;
    /// Returns whether light of any highlight reaches a rectangle of the image, px.
    [[nodiscard]] virtual bool reach(int x, int y, int width, int height) const = 0;
    /// Adds four values per pixel to `light`, in rows of TileViews::row pixels. The first three are r, g and
    /// b. The fourth is the mean square of the highlights' radiance along single rays through the lens, in
    /// the brightest channel.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
    /// A line of sight along which a highlight reaches a pixel, unless something hides it. The light of all
    /// highlights in the pixel is the mean, over such lines, of `scale` times the radiance of the line's
    /// highlight.
    struct Line {
        SightLine line;
        NodeIdentity highlight;
        double scale = 0;
    };
    /// Returns the indices of the light sources whose light may reach a rectangle of the image, px.
    [[nodiscard]] virtual std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const = 0;
    /// Appends up to `count` random lines to the pixel (x, y) of the image, from those of `sources` that
    /// reach it. `seed` determines the lines.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Comparison of rays with records in one pixel. A residual is the radiance of a ray minus the radiance of
/// the records, for one view. If the image takes the sample from a ray anyway, its residual is 0.
struct PixelCheck {
    std::uint32_t views = 0;
    std::uint32_t rays = 0;       ///< all rays of the pixel, except the `aimed` ones
    std::array<double, 3> sum{};  ///< sum of the residuals of `views` views, scene-linear
    [[nodiscard]] double mean(std::size_t channel) const { return views > 0 ? sum[channel] / views : 0; }
    /// Light of the highlights in the pixel, scene-linear. `highlights`: the light that was added to the
    /// image. `aimed_sum`: the sum of the light that `aimed` rays found, which were sent towards the
    /// highlights.
    std::array<float, 3> highlights{};
    std::array<double, 3> aimed_sum{};
    std::uint32_t aimed = 0;
    float aimed_share = 0;  ///< the result of PatchViews::aimed
    /// Residual of the highlights: their mean light along rays, minus the light in the image.
    [[nodiscard]] double highlight_residual(std::size_t channel) const {
        return aimed > 0 ? aimed_sum[channel] / aimed - static_cast<double>(highlights[channel]) : 0;
    }
};

struct PatchPicture {
    PatchPicture() = default;
    /// All pixels black and unknown.
    PatchPicture(int width, int height);
    Image image;  ///< mean of all samples of views that are known; black if none is
    std::vector<float>
        unknown;  ///< per pixel: share of the views' weight for which no directly visible surface is recorded
    /// Per pixel: share of the views' weight for which a reflected or transmitted surface is not recorded.
    /// Such a surface counts less if it is dim compared with the pixel everywhere in the tile (TreeSums).
    std::vector<float> unknown_below;
    /// Per pixel: share of the views' weight that comes from rays. Empty for sets without rays.
    std::vector<float> traced;
    /// Per pixel, the sums of residuals (ray minus records). Empty for sets without `checked`.
    std::vector<PixelCheck> checks;
    /// Per pixel, the fourth value that Lights::add computes. Empty if there are no lights.
    std::vector<float> light_square;
    /// Per pixel, the bits (PatchField::class_marks) of all moving objects that are recorded there or that a
    /// view sees there. All bits are set if a view sees no recorded surface. 0 means that every view sees the
    /// surface that is recorded at this pixel.
    std::vector<std::uint8_t> touched;
};

/// Draws the sets of views into the images `out`, which have the field's size. Square pieces of an image that
/// no set draws keep their values. The result is bit-identical for any number of threads, and does not depend
/// on how sets are divided into calls. Exception, with rays and moving objects: all views of a call together
/// determine how many reflected and transmitted patches may appear in a piece, and if these are too many,
/// rays replace all samples of surfaces that reflect or transmit.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
