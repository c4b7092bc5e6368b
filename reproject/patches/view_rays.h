// A view is the image for one lens point and instant. Selects pixels of single views in which rays are
// traced. Rays replace uncertain colours, for example at edges, or measure the error of the other colours.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/seen_light.h"
#include "reproject/patches/tree_sums.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// The surfaces that one view shows in a tile of the image. A view is the image for one lens point and
/// instant. `seen` tells which surface each pixel of the tile shows. It points to one SeenTile, or to two if
/// the view blends two recorded instants.
struct ShownView {
    const PatchField& field;
    const PatchView& view;
    TilePlace at;
    SeenTile* seen = nullptr;  ///< one or two, per use

    [[nodiscard]] const PatchMesh& mesh(std::size_t u) const {
        return *field.instants[view.uses[u].instant].primary;
    }
    /// Returns the id of the object that pixel `k` of the view shows. A view may blend two recorded instants,
    /// which may show different objects in the pixel. `u` (0 or 1) selects one of these instants.
    [[nodiscard]] std::uint32_t id(std::size_t u, std::size_t k) const {
        return mesh(u).id_of(seen[u].texel[k]);
    }
    /// A view may blend the colours from two recorded instants. Returns the weight, 0 to 1, of the colour
    /// from instant `u` (0 or 1) in pixel `k`. If both instants show the same surface there, the weight is
    /// Use::share. If the other instant shows no surface, it is 1. Of two different surfaces, only the nearer
    /// one counts, or only the farther one if has_vague_outline is true for the nearer one, whose outline may
    /// then be wrong.
    [[nodiscard]] double share(std::size_t u, std::size_t k) const {
        const std::size_t o = 1 - u;
        if (seen[o].texel[k] == SeenTile::no_texel) return 1;
        const float mine = seen[u].inverse_z[k], other = seen[o].inverse_z[k];
        if (id(u, k) == id(o, k) && std::abs(mine - other) <= same_depth * std::max(mine, other))
            return view.uses[u].share;
        const std::size_t nearer = mine > other || (mine == other && u == 0) ? u : o;
        return has_vague_outline(nearer, k) ? nearer != u : nearer == u;
    }
    /// Returns whether the recorded instant `u` (0 or 1) has the less precise outline of the object in pixel
    /// `k`. This matters if a view blends two recorded instants that show different surfaces in the pixel.
    /// The outline is less precise at the instant at which the object appears smaller, because fewer samples
    /// then recorded it.
    [[nodiscard]] bool has_vague_outline(std::size_t u, std::size_t k) const;
    /// Returns whether light through the lens point reaches pixel (x, y) of the tile. Otherwise, vignetting
    /// blocks it.
    [[nodiscard]] bool passes(int x, int y) const {
        return !view.passes || view.passes(at.x - field.x + x, at.y - field.y + y);
    }
    /// Adds to `lines` the ray through pixel (x, y) of the tile. The new element is created in the list
    /// first, and its members are then written in place. If the element were built outside the list and then
    /// copied, the copy would read values just written, which stalls the processor.
    void add_line(int x, int y, std::vector<SightLine>& lines) const {
        SightLine& line = lines.emplace_back();
        line.x = at.x + x;
        line.y = at.y + y;
        line.place = view.sample;
        line.lens = view.lens_point;
        line.light_before = view.light_before;
        line.set = view.set;
        line.view = view.number;
    }

    /// A pixel shows the same surface at two recorded instants if the ids are equal and the inverse depths
    /// differ by at most this fraction.
    static constexpr float same_depth = 0.02F;
};

/// Number of rays that are traced in one batch: enough for efficiency, and few enough for the caches.
inline constexpr std::size_t lines_together = 4096;

/// The samples of views that rays replace in a tile.
class RaySamples {
  public:
    LeftToRays left = LeftToRays::unsure;  ///< what rays replace in the tile
    bool parents_too = false;  ///< whether the samples of surfaces that reflect or transmit are rays
    /// Statistics about view samples, i.e. about what single views show in single pixels. `with_trees` counts
    /// the samples that show a mirror or glass. `with_sure_trees` counts those among them that need no ray,
    /// because all their reflections and refractions are recorded accurately.
    std::size_t with_trees = 0, with_sure_trees = 0;
    LightSums sum{};  ///< of the traced radiance
    /// For each pixel: bits that tell which colours are replaced by a ray. A view's colour comes from one
    /// recorded instant or is blended from two, instants 0 and 1. If bit 0 is set, a ray replaces the colour
    /// from instant 0. Bit 1 does the same for instant 1.
    std::array<std::uint8_t, SeenTile::pixels> uses{};

    /// Schedules a ray for each pixel in which the directly visible surface is uncertain, for example because
    /// an edge crosses it. If objects move, also schedules a ray for each pixel that shows a mirror or glass,
    /// because a reflection moves differently from its mirror. With `parents_too`, mirrors and glass get rays
    /// in any case, and if rays replace the whole tile, all pixels get one. The scheduled rays replace the
    /// recorded colours of these pixels.
    void set_aside(const ShownView& shown, LightSums& recorded);
    /// Schedules a ray for each pixel that shows a mirror or glass whose reflections or refractions are
    /// missing or inaccurate. The ray replaces the recorded colour. `trees` holds the reflections and
    /// refractions as they were recorded at the view's instant `u`, which is 0 or 1 because a view may blend
    /// two recorded instants.
    void set_aside_trees(const ShownView& shown, std::size_t u, const TreeSums& trees, LightSums& recorded);
    /// Returns whether rays replace all samples of views in the tile.
    [[nodiscard]] bool whole_tile() const { return left != LeftToRays::unsure; }
    [[nodiscard]] bool full() const { return lines_.size() >= lines_together; }
    /// Traces the rays and adds them to `sum`.
    void trace(const PatchViews& set);

  private:
    void find_doubtful(const ShownView& shown, bool parents);
    /// Replaces the share `weight` of one view's sample by a ray.
    void leave_to_rays(const ShownView& shown, int x, int y, double weight, LightSums& recorded);

    PixelList doubtful_;
    std::vector<SightLine> lines_;
    std::vector<std::uint16_t> pixel_;
    std::vector<double> weight_;
    std::vector<std::array<float, 3>> radiance_;
};

/// Measures the error of recorded colours by tracing rays (check rays) in selected pixels. Each check ray
/// goes through the lens point of one view at the view's instant, and its radiance is compared with the
/// colour that the view shows in the pixel. The rays do not change the image.
class CheckedSamples {
  public:
    std::vector<PixelCheck> sums;  ///< per pixel

    void begin(const PatchField& field, const PatchViews& set, const TilePlace& at);
    /// Stores the colours of a view (image for one lens point and instant), so that `check` can compare them
    /// with rays later. Only pixels that the function PatchViews::checked selects for this view are stored. A
    /// view may be made from two recorded instants; call this function once for each of them.
    /// - `number`: index of the view in PatchViews::views
    /// - `u`: which of the view's recorded instants, 0 or 1
    /// - `trees`: reflections and refractions; null if none are drawn
    void note(const ShownView& shown, std::size_t number, std::size_t u, const RaySamples& rays,
              const TreeSums* trees);
    [[nodiscard]] bool full() const { return lines_.size() >= lines_together; }
    /// Traces the rays and adds the residuals to `sums`.
    void check(const PatchViews& set);

  private:
    std::vector<std::vector<std::uint16_t>> pixels_;  ///< per view, with repetitions
    std::vector<std::uint32_t> views_;
    std::vector<SightLine> lines_;
    std::vector<std::uint16_t> pixel_;
    std::vector<glm::dvec4> noted_, recorded_;
    std::vector<std::array<float, 3>> radiance_;
};

}  // namespace postlens
