// Means of many views of the sheets, each from its own point of the lens and at its own instant.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "records/image.h"
#include "reproject/patch_raster.h"
#include "reproject/patches.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// One instant's sheets.
struct PatchInstant {
    const PatchMesh* primary = nullptr;
    const PatchMesh* deeper = nullptr;  ///< null: nothing is seen in mirrors or through glass
};

/// One view: up to two recorded instants, each moved to where the view is, and blended.
struct PatchView {
    glm::dvec2 sample{0.5};  ///< where in every pixel it looks, px
    double weight = 1;
    struct Use {
        std::size_t instant = 0;
        double share = 1;  ///< of the colour where both instants show the same surface
        /// The motion by class; empty: nothing moves.
        std::vector<RasterMap> motions;
    };
    std::vector<Use> uses;  ///< one or two
    LensShift lens;         ///< after the motion
    /// Whether light gets through to the pixel (x, y) of the picture; none: to all. What does not is black.
    std::function<bool(int x, int y)> passes;
    glm::dvec2 lens_point{0};   ///< SightLine's, where there are rays
    double light_before = 0.5;  ///< likewise
    std::uint32_t set = 0;      ///< likewise
    std::uint32_t number = 0;   ///< of the set's views, likewise
};

/// Views that a picture, or some of its tiles, is the mean of.
struct PatchViews {
    std::vector<PatchView> views;
    /// Whether a piece of the picture (PatchField::piece_px) is wanted of them; none: all is. What is not
    /// stays black and unknown.
    std::function<bool(int x, int y, int width, int height)> wanted;
    /// May add light of its own to a tile, knowing what every view sees there; from several threads. None:
    /// nothing is added.
    const class Lights* lights = nullptr;
    /// Looks where the records are not sure what a view sees; none: what they have stands.
    const SightRays* rays = nullptr;
    /// With rays: whether a tile of the picture is left to them altogether. None: no tile is.
    std::function<bool(int x, int y)> left_to_rays;
    LightElsewhere less;  ///< what rays are not to see, as `lights` add it
    /// With rays: which views of a pixel of the picture are compared with a ray, into `views`, each as often
    /// as it is named; they change nothing in the picture. None: no view is.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Which of the pictures they are of. Sets that share one want different tiles.
    std::size_t picture = 0;
};

struct PatchField {
    std::vector<PatchInstant> instants;
    /// The motion class of an id; not asked for where nothing moves and there are no marks.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// By class: bits that tell where what moves was seen; 0 for what stands still in every view. Empty: it
    /// is not told.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< tiles that none of these can touch are left as they are
    /// Sets are asked for by squares of so many px, a tile of SeenTile::edge or some even part of it.
    int piece_px = SeenTile::edge;
    /// Drawn together: where patches lie is found out once for all.
    std::vector<PatchViews> sets;
    int x = 0, y = 0;  ///< raster px of the pictures' first pixel
    int width = 0, height = 0;
    /// Raster px that have records: their first and the first after them. Of sets with rays.
    glm::ivec2 recorded_begin{0}, recorded_end{0};
    /// Where a set's `lights` look at TileViews::patches: how far the lens goes from its middle, as
    /// LensShift::lens_px.
    glm::dvec2 lens_reach_px{0};
};

/// What every view sees in a tile, of its first use's primary sheets.
struct TileViews {
    int x = 0, y = 0, width = 0, height = 0;            ///< px of the picture
    static constexpr std::size_t row = SeenTile::edge;  ///< pixels to the next row of a view
    static constexpr std::size_t view = row * row;      ///< and to the next view
    std::vector<float> inverse_z;                       ///< -1: nothing known
    std::vector<std::uint32_t> texel;
    /// The primary patches that any point of the lens may see here, the nearest first; null where things
    /// move.
    const PatchMesh* patches = nullptr;
};

/// Light that is not in the sheets.
class Lights {
  public:
    Lights() = default;
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;
    Lights(Lights&&) = delete;
    Lights& operator=(Lights&&) = delete;
    virtual ~Lights() = default;
    [[nodiscard]] virtual bool reach(int x, int y, int width, int height) const = 0;
    /// Four for each pixel, in rows of TileViews::row pixels: colour, and that times the radiance of what it
    /// comes from, both of the brightest channel: the mean square of what single rays would meet.
    virtual void add(const TileViews& views, std::vector<double>& light) const = 0;
    static constexpr std::size_t values = 4;
};

/// What rays have shown more than the records, of some of a pixel's views: 0 of those that were traced
/// anyhow.
struct PixelCheck {
    std::uint32_t views = 0, rays = 0;
    std::array<double, 3> sum{};  ///< radiance
    [[nodiscard]] double mean(std::size_t channel) const { return views > 0 ? sum[channel] / views : 0; }
};

struct PatchPicture {
    PatchPicture() = default;
    /// Of which nothing is known yet.
    PatchPicture(int width, int height);
    Image image;                 ///< mean of what is known; black where nothing is
    std::vector<float> unknown;  ///< share of the views' weight in which no surface is known there
    /// Share of the views' weight in which something is seen in a mirror or glass that was not recorded; of
    /// what is dimmer than the pixel wherever it is seen within the tile so much less (TreeSums).
    std::vector<float> unknown_below;
    /// That of it for which too few views see the same to stand in: what the pinhole saw there does.
    std::vector<float> guessed_below;
    /// Share of the views' weight that was traced, of sets with rays; else empty.
    std::vector<float> traced;
    /// Of sets with `checked`; else empty.
    std::vector<PixelCheck> checks;
    /// The squares that `Lights` tell; empty without.
    std::vector<float> light_square;
    /// With PatchField::class_marks: the marks of all that moves and is seen there in a view, or was recorded
    /// there; all bits where a view sees nothing known. 0: all views see what was recorded.
    std::vector<std::uint8_t> touched;
};

/// Into pictures of the field's size: what is not wanted keeps what it has. Same bits for any number of
/// threads, and whichever sets are drawn together.
void patch_field(const PatchField& field, std::span<PatchPicture> out);

}  // namespace postlens
