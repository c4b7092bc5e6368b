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
        /// The motions from the recorded instant to the view's instant, one for each class of objects that
        /// move alike. Empty if nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< shift by the lens, applied after the motion
    /// Returns whether the lens transmits light to the pixel (x, y) of the image. Pixels without light are
    /// black. If the function is empty, all pixels get light.
    std::function<bool(int x, int y)> passes;
    // Lens point, instant and indices of this view's rays. The members correspond to those of SightLine
    // (`number` to SightLine::view). Only used if rays are traced.
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

/// A set of views. The mean of the views is an image or a part of an image.
struct PatchViews {
    std::vector<PatchView> views;
    /// Selects the pieces (squares with an edge of PatchField::piece_px) of the image that this set of views
    /// draws. If the function is empty, the set draws all pieces. Pieces that no set draws stay black, with
    /// PatchPicture::unknown = 1.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds the light of highlights (bright spots that the lens spreads over many pixels) to the image. The
    /// surfaces that the views see may hide highlights. Several threads call it at the same time. Null if
    /// there are no highlights.
    const class Lights* lights = nullptr;
    /// Traces the rays that replace samples whose colour the records do not determine. If null, all samples
    /// keep their recorded colours.
    const SightRays* rays = nullptr;
    /// Returns which samples rays replace in the piece (square) of the image that contains the pixel (x, y).
    /// Only used if `rays` is set. If the function is empty, rays replace only samples whose colour the
    /// records do not determine (LeftToRays::unsure).
    std::function<LeftToRays(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< radiance that `lights` adds, and that rays therefore leave out
    /// Selects the samples of pixel (x, y) that are compared with rays: appends the indices of their views to
    /// `views`. The results are stored in PatchPicture::checks and do not change the image. Only used if
    /// `rays` is set. If the function is empty, no samples are compared.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Selects pixels whose highlights are also checked by rays that are aimed at the highlights. Returns the
    /// probability with which the pixel (x, y) was selected, or 0 if it was not selected. Only used together
    /// with `checked`. If the function is empty, no pixel is selected.
    std::function<double(int x, int y)> aimed;
    /// Index of the image that this set of views draws, in the argument `out` of patch_field. Sets that draw
    /// one image together must draw different pieces of it.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// Returns the motion class of an object. All objects of a class move alike. Only called if objects move
    /// or if `class_marks` is not empty.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// For each class of objects that move alike, the bits that mark it. In PatchPicture::touched, a pixel
    /// gets the bits of all objects that any view sees there. The bits of a class that does not move in any
    /// view are 0. If the list is empty, `touched` is not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles in which none of these bits can be set are not drawn
    /// Edge of a piece (square of the image that is drawn as one task), in px. It is SeenTile::edge divided
    /// by a power of two.
    int piece_px = SeenTile::edge;
    /// The sets of views. The patches (planar parts of surfaces) of a tile are searched once for all sets.
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// The recorded part of the raster: its first pixel, and one past its last pixel. Surfaces outside it are
    /// not recorded, but may hide what a view sees. With rays or moving objects, pixels that they may hide
    /// count as unknown, unless the two values are equal. Must be set if a set of views has rays.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// The extent of the lens: the largest |x| and |y| of a lens point, in m times film distance / pixel
    /// pitch (px m). Patches that are visible from any such point are collected, even if no view sees them.
    /// TileViews::patches and rays need these patches, so the extent must be set if either is used.
    glm::dvec2 lens_reach_px{0};
};

/// The directly visible surfaces that each view sees in a square piece of the image. If a view is made from
/// two recorded instants, only the surfaces of the first are stored.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1 if nothing is recorded
    std::vector<std::uint32_t> texel;
    /// The directly visible patches (planar parts of surfaces) that any lens point can see in this piece,
    /// nearest first. Null if objects move.
    const PatchMesh* patches = nullptr;
};

/// The highlights of an image. Radiance above a limit is removed from a reprojected surface and becomes a
/// highlight. The lens spreads this light over the pixels by the highlight's impulse response (point spread
/// function).
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
    /// Adds four values per pixel to `light`, whose rows have TileViews::row pixels. The first three are the
    /// light of the highlights in r, g and b. The fourth is the mean, over rays through the lens, of the
    /// square of the highlights' radiance in the brightest channel.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
    /// A line of sight from a pixel to a highlight. The highlight's light arrives along this line unless a
    /// surface blocks it. The light of all highlights in the pixel is the mean, over such lines, of `scale`
    /// times the arriving radiance.
    struct Line {
        SightLine line;
        NodeIdentity highlight;
        double scale = 0;
    };
    /// Returns the indices of the sources (groups of merged highlights) whose light may reach a rectangle of
    /// the image, in px.
    [[nodiscard]] virtual std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const = 0;
    /// Appends up to `count` random lines from the pixel (x, y) of the image to highlights of `sources` whose
    /// light reaches the pixel. Equal seeds give equal lines.
    virtual void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                     std::vector<Line>& lines) const = 0;
};

/// Compares rays with recorded radiance in one pixel. The residual of a view is the radiance of its ray minus
/// the recorded radiance. The residual is 0 if the image uses the ray instead of the record.
struct PixelCheck {
    std::uint32_t views = 0;
    std::uint32_t rays = 0;       ///< all rays of the pixel, except the `aimed` ones
    std::array<double, 3> sum{};  ///< sum of the residuals of `views` views, scene-linear
    [[nodiscard]] double mean(std::size_t channel) const { return views > 0 ? sum[channel] / views : 0; }
    /// `highlights` is the light of the highlights in this pixel of the image, scene-linear. To measure the
    /// error of this light, `aimed` rays are traced towards the highlights. `aimed_sum` is the sum of the
    /// light along these rays.
    std::array<float, 3> highlights{};
    std::array<double, 3> aimed_sum{};
    std::uint32_t aimed = 0;
    float aimed_share = 0;  ///< the result of PatchViews::aimed
    /// Light of the highlights as measured by the aimed rays, minus their light in the image.
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
    /// Per pixel: weighted share of the views that need a reflected or transmitted surface that is not
    /// recorded. The share is reduced if such surfaces are darker in the whole tile than the pixel
    /// (TreeSums).
    std::vector<float> unknown_below;
    /// Per pixel: weighted share of the views whose samples come from rays. Empty for sets without rays.
    std::vector<float> traced;
    /// Per pixel: results of comparing rays with records. Empty for sets without `checked`.
    std::vector<PixelCheck> checks;
    /// Per pixel: mean squared radiance of the highlights (the fourth value of Lights::add). Empty if there
    /// are no highlights.
    std::vector<float> light_square;
    /// Per pixel: the bits (PatchField::class_marks) of all moving objects that are recorded at this pixel or
    /// that any view sees there. All bits are set if a view sees something that is not recorded. If no bit is
    /// set, all views see the surface that is recorded here.
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
