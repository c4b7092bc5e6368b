// Reprojects the recorded surfaces to many views and averages them. A view is an image for one lens point and
// one instant.
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
    /// Patches of reflected and transmitted nodes; null if there are none.
    const PatchMesh* deeper = nullptr;
};

/// An image for one lens point and one instant. It is made from the surfaces of one or two recorded instants,
/// which are reprojected to this lens point and instant. If there are two, their images are blended.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of the colour at this instant if both instants show the same surface
        /// For each class of objects that move alike, the motion from the recorded instant to the view's
        /// instant. Empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether the lens transmits light to the pixel (x, y) of the image. Pixels without light are
    /// black. If the function is empty, all pixels get light.
    std::function<bool(int x, int y)> passes;
    // These values are copied to the SightLine of each ray, if the set of views has rays. `number` becomes
    // SightLine::view.
    glm::dvec2 lens_point{0};
    double light_before = 0.5;
    std::uint32_t set = 0;
    std::uint32_t number = 0;

    /// Returns whether something moves between the recorded instants and the view's instant.
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

/// A set of views. The mean of the views is an image, or the part of an image that this set draws.
struct PatchViews {
    std::vector<PatchView> views;
    /// Returns whether this set of views draws a piece of the image. A piece is a square with an edge of
    /// PatchField::piece_px. If the function is empty, the set draws all pieces. Pieces that no set draws
    /// stay black and unknown.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds highlights to a piece of the image. The surfaces that the views see in the piece determine which
    /// highlights are hidden. Several threads call it at the same time. Null if there are no highlights.
    const class Lights* lights = nullptr;
    /// Traces rays. If the records do not determine the colour of a view's sample in a pixel, a ray replaces
    /// the sample. If null, all samples keep their recorded colours.
    const SightRays* rays = nullptr;
    /// Returns what rays replace in the piece that contains the pixel (x, y). Only used if there are rays. If
    /// the function is empty, rays replace what LeftToRays::unsure describes.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Appends the indices of the views whose samples in the pixel (x, y) are compared with a ray. Only used
    /// if there are rays. The results are stored in PatchPicture::checks and do not change the image. If the
    /// function is empty, no samples are compared.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Decides whether rays are aimed at the highlights of the pixel (x, y). Returns the probability with
    /// which the pixel was chosen, or 0 if it was not chosen. Only used together with `checked`. If the
    /// function is empty, no pixel is chosen.
    std::function<double(int x, int y)> aimed;
    /// Index of the image that this set of views draws. Sets that draw the same image must draw different
    /// pieces of it.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Returns the class to which an object belongs. All objects of a class move alike. Only called if
    /// objects move or if `class_marks` is not empty.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// For each class of objects, the bits that are set in PatchPicture::touched where a view sees an object
    /// of this class. A class that does not move in any view has no bits. If the list is empty, `touched` is
    /// not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// Edge of a piece in px. It is SeenTile::edge divided by a power of two.
    int piece_px = SeenTile::edge;
    /// The sets of views. They share the search for the patches (planar parts of surfaces) of a tile.
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// The rectangle of raster pixels that have records. `recorded_begin` is its first pixel, and
    /// `recorded_end` is one past its last pixel. Sets with rays need the rectangle. A surface may continue
    /// beyond its border and hide what a view sees. If the set has rays or if something moves, the pixels
    /// where this may happen count as unknown. If both values are equal, surfaces are assumed to end at the
    /// border.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Largest distance of a lens point from the lens's centre, in units of LensShift::lens_px. The search
    /// for patches covers all lens points within this distance, not only those of the views. Set this value
    /// if `lights` uses TileViews::patches or if there are rays.
    glm::dvec2 lens_reach_px{0};
};

/// For each view, the directly visible surfaces that it sees in a piece of the image. The surfaces are those
/// of the first recorded instant that the view uses.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1 if nothing is recorded
    std::vector<std::uint32_t> texel;
    /// The directly visible patches (planar parts of surfaces) that can be seen here from any lens point,
    /// nearest first. Null if objects move.
    const PatchMesh* patches = nullptr;
};

/// Highlights are bright radiance that was removed from the reprojected surfaces. Each highlight is spread
/// over the image by its impulse response, the distribution of its light over the pixels.
class Lights {
  public:
    Lights() = default;
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;
    Lights(Lights&&) = delete;
    Lights& operator=(Lights&&) = delete;
    virtual ~Lights() = default;
    /// Returns whether the light of any highlight reaches a rectangle of the image. Coordinates are in px.
    [[nodiscard]] virtual bool reach(int x, int y, int width, int height) const = 0;
    /// Adds four values per pixel to `light`, which has rows of TileViews::row pixels. The first three are
    /// the light of the highlights: r, g and b. The fourth is the mean, over rays through the lens, of the
    /// squared radiance of the highlights in the brightest channel.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
    /// A line of sight from a pixel to a highlight. The light of the highlight arrives along this line unless
    /// a surface blocks it. The light of all highlights in the pixel is the mean over such lines. Each line
    /// contributes `scale` times the radiance of its highlight.
    struct Line {
        SightLine line;
        NodeIdentity highlight;
        double scale = 0;
    };
    /// Returns the indices of the light sources whose light may reach a rectangle of the image. Coordinates
    /// are in px.
    [[nodiscard]] virtual std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const = 0;
    /// Appends up to `count` random lines from the pixel (x, y) of the image to those highlights of `sources`
    /// whose light reaches the pixel. Equal seeds give equal lines.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Compares rays with records in one pixel. The residual of a view is the radiance of its ray minus the
/// radiance of the records. The residual is 0 if the image takes the sample from a ray anyway.
struct PixelCheck {
    std::uint32_t views = 0;
    std::uint32_t rays = 0;       ///< all rays of the pixel, except the `aimed` ones
    std::array<double, 3> sum{};  ///< sum of the residuals of `views` views, scene-linear
    [[nodiscard]] double mean(std::size_t channel) const { return views > 0 ? sum[channel] / views : 0; }
    /// Light of the highlights in the pixel, scene-linear. `highlights` is the light that was added to the
    /// image. `aimed_sum` is the sum of the radiance along the `aimed` rays, which are traced towards the
    /// highlights.
    std::array<float, 3> highlights{};
    std::array<double, 3> aimed_sum{};
    std::uint32_t aimed = 0;
    float aimed_share = 0;  ///< the result of PatchViews::aimed
    /// Mean light of the highlights along the rays, minus their light in the image.
    [[nodiscard]] double highlight_residual(std::size_t channel) const {
        return aimed > 0 ? aimed_sum[channel] / aimed - static_cast<double>(highlights[channel]) : 0;
    }
};

struct PatchPicture {
    PatchPicture() = default;
    /// All pixels black and unknown.
    PatchPicture(int width, int height);
    Image image;  ///< mean of all known samples of views; black if no sample is known
    std::vector<float>
        unknown;  ///< per pixel: share of the views, by weight, that see no recorded surface here
    /// Per pixel: the share of the views, by weight, that need a reflected or transmitted surface which is
    /// not recorded. Surfaces that are dim in the whole tile count less (TreeSums).
    std::vector<float> unknown_below;
    /// Per pixel: the share of the views, by weight, whose samples come from rays. Empty for sets without
    /// rays.
    std::vector<float> traced;
    /// Per pixel, the sums of residuals (ray minus records). Empty for sets without `checked`.
    std::vector<PixelCheck> checks;
    /// Per pixel, the fourth value that Lights::add computes. Empty if there are no lights.
    std::vector<float> light_square;
    /// Per pixel, the bits (PatchField::class_marks) of all moving objects that are recorded there or that a
    /// view sees there. All bits are set if a view sees a place that is not recorded. 0 means that every view
    /// sees the surface that is recorded at this pixel.
    std::vector<std::uint8_t> touched;
};

/// Draws the sets of views into the images `out`, which have the size of the field. Pieces of an image that
/// no set draws keep their values. The result is bit-identical for any number of threads.
///
/// The sets may be drawn by one call or by several calls. The result is the same, unless there are rays and
/// moving objects. In that case, more views in a call mean more reflected and transmitted patches in a piece.
/// If there are too many patches, rays replace all samples of surfaces that reflect or transmit.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
