// The mean of many views of the recorded surfaces, each from its own lens point and at its own instant.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pictures/image.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patches.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// The patches of one recorded instant.
struct PatchInstant {
    const PatchMesh* primary = nullptr;
    const PatchMesh* deeper = nullptr;  ///< patches of reflected and transmitted nodes; null: there are none
};

/// One view: up to two recorded instants, each reprojected to the view, and blended.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< sample position in every pixel, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< weight of its colour in pixels where both instants show the same surface
        /// Per class of objects that move alike, their motion from the recorded instant to the view's
        /// instant; empty: nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< applied after the motion
    /// Whether the lens transmits light to the pixel (x, y) of the image; pixels without light are black.
    /// None: it transmits to all pixels.
    std::function<bool(int x, int y)> passes;
    // Members of SightLine, for sets with rays; `number` is its `view`.
    glm::dvec2 lens_point{0};
    double light_before = 0.5;
    std::uint32_t set = 0;
    std::uint32_t number = 0;
};

/// A set of views. An image, or some of its pieces, is the mean of them.
struct PatchViews {
    std::vector<PatchView> views;
    /// Whether this set draws a piece, a square of the image with edge PatchField::piece_px; none: it draws
    /// all pieces. Pieces that no set draws stay black and unknown.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// Adds highlights to a square piece of the image, given what every view sees there. Called from several
    /// threads. Null: there are no highlights.
    const class Lights* lights = nullptr;
    /// Traces a ray for each view sample that the records do not determine. Null: such samples stay as
    /// recorded.
    const SightRays* rays = nullptr;
    /// With rays: whether all view samples of the piece with the pixel (x, y) are rays. None: false
    /// everywhere.
    std::function<bool(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< radiance that `lights` add, which rays leave out
    /// With rays: appends the numbers of the views whose samples of the pixel (x, y) are compared with a ray.
    /// The comparisons go to PatchPicture::checks and do not change the image. None: no comparisons.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Number of the image that this set draws. Sets of one image must draw different pieces.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// The class of an object: objects of one class move alike. Only called if objects move or `class_marks`
    /// is not empty.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// Per class of objects that move alike, the bits that PatchPicture::touched gets where a view sees such
    /// an object; 0 for a class that does not move in any view. Empty: `touched` is not computed.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles where none of these bits can occur are not drawn
    /// Edge of a piece, px: SeenTile::edge divided by a power of two.
    int piece_px = SeenTile::edge;
    /// All sets share the search for the patches of a tile.
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the images' first pixel
    int width = 0, height = 0;
    /// The raster px [begin, end) that have records. Only for sets with rays.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Extent of the lens from its centre, as LensShift::lens_px. Only for sets whose `lights` use
    /// TileViews::patches.
    glm::dvec2 lens_reach_px{0};
};

/// The primary surfaces that every view sees in a piece of the image, from the view's first recorded instant.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the image
    static constexpr std::size_t row = SeenTile::edge;  ///< stride from one row of a view to the next
    static constexpr std::size_t view = row * row;      ///< stride from one view to the next
    std::vector<float> inverse_z;                       ///< 1/m; -1: nothing recorded
    std::vector<std::uint32_t> texel;
    /// The primary patches that any lens point may see here, nearest first; null if objects move.
    const PatchMesh* patches = nullptr;
};

/// Highlights: radiance that was taken out of the reprojected surfaces and is spread by its impulse response.
class Lights {
  public:
    Lights() = default;
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;
    Lights(Lights&&) = delete;
    Lights& operator=(Lights&&) = delete;
    virtual ~Lights() = default;
    /// Whether light of any highlight reaches a rectangle of the image, px.
    [[nodiscard]] virtual bool reach(int x, int y, int width, int height) const = 0;
    /// Adds four values per pixel to `light`, in rows of TileViews::row pixels: r, g, b, and the mean square,
    /// in the brightest channel, of the highlights' radiance along single rays through the lens.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
};

/// Residuals of a pixel's views that are compared with a ray: the ray's radiance minus that of the records.
/// View samples that the image takes from rays anyway count as residual 0.
struct PixelCheck {
    std::uint32_t views = 0, rays = 0;
    std::array<double, 3> sum{};  ///< sum of the residuals of `views` views, scene-linear
    [[nodiscard]] double mean(std::size_t channel) const { return views > 0 ? sum[channel] / views : 0; }
};

struct PatchPicture {
    PatchPicture() = default;
    /// All pixels black and unknown.
    PatchPicture(int width, int height);
    Image image;  ///< mean of the view samples that are known; black if none is
    std::vector<float>
        unknown;  ///< per pixel: share of the views' weight whose primary surface is not recorded
    /// Per pixel: share of the views' weight whose reflected or transmitted node is not recorded. A node that
    /// is dimmer than the pixel everywhere in the tile counts as much less (TreeSums).
    std::vector<float> unknown_below;
    /// The part of `unknown_below` for which too few other views see the node: it gets the radiance that the
    /// pinhole sees.
    std::vector<float> guessed_below;
    /// Per pixel: share of the views' weight that is rays. Empty for sets without rays.
    std::vector<float> traced;
    /// Per pixel; empty for sets without `checked`.
    std::vector<PixelCheck> checks;
    /// Per pixel, the fourth value of `Lights`; empty without lights.
    std::vector<float> light_square;
    /// Per pixel, the bits (PatchViews::class_marks) of all moving objects that are recorded there or that a
    /// view sees there; all bits if a view sees nothing recorded. 0: every view sees what is recorded there.
    std::vector<std::uint8_t> touched;
};

/// Draws the sets of views into `out`, images of the field's size. Square pieces of the image that no set
/// draws keep their values. The result is bit-identical for any number of threads and any division of sets
/// into calls.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
