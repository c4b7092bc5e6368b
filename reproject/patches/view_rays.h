// Traces rays for single pixels of single views (images for one lens point and instant). Some rays replace
// recorded colours that are uncertain, for example at edges. Other rays measure the error of the recorded
// colours that are not replaced.
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

/// The surfaces that one view (image for one lens point and instant) shows in a tile of the image. `seen`
/// points to one SeenTile for each of the one or two recorded instants that the view uses.
struct ShownView {
    const PatchField& field;
    const PatchView& view;
    TilePlace at;
    SeenTile* seen = nullptr;  ///< one or two, per use

    [[nodiscard]] const PatchMesh& mesh(std::size_t u) const {
        return *field.instants[view.uses[u].instant].primary;
    }
    /// Returns the id of the object that pixel `k` of the view shows according to one recorded instant. A
    /// view may be blended from two recorded instants, between which its own instant lies. `u` (0 or 1)
    /// selects one of these two.
    [[nodiscard]] std::uint32_t id(std::size_t u, std::size_t k) const {
        return mesh(u).id_of(seen[u].texel[k]);
    }
    /// Returns the weight, 0 to 1, of the colour from the recorded instant `u` (0 or 1) in pixel `k`:
    /// - If only instant `u` shows a surface there, the weight is 1.
    /// - If both instants show the same surface, the weight is Use::share.
    /// - If they show different surfaces, one has the weight 1 and the other 0.
    [[nodiscard]] double share(std::size_t u, std::size_t k) const {
        const std::size_t o = 1 - u;
        if (seen[o].texel[k] == SeenTile::no_texel) return 1;
        const float mine = seen[u].inverse_z[k], other = seen[o].inverse_z[k];
        if (id(u, k) == id(o, k) && std::abs(mine - other) <= same_depth * std::max(mine, other))
            return view.uses[u].share;
        // The nearer surface has the weight 1, unless its outline is imprecise.
        const std::size_t nearer = mine > other || (mine == other && u == 0) ? u : o;
        return has_vague_outline(nearer, k) ? nearer != u : nearer == u;
    }
    /// Returns whether the outline of the object in pixel `k` is less precise in the records of instant `u`
    /// (0 or 1) than in those of the other instant. An object that is smaller in the image is recorded by
    /// fewer samples, so its outline is less precise.
    [[nodiscard]] bool has_vague_outline(std::size_t u, std::size_t k) const;
    /// Returns whether light through the view's lens point reaches pixel (x, y) of the tile. Otherwise,
    /// vignetting blocks it.
    [[nodiscard]] bool passes(int x, int y) const {
        return !view.passes || view.passes(at.x - field.x + x, at.y - field.y + y);
    }
    /// Adds to `lines` the ray through pixel (x, y) of the tile.
    void add_line(int x, int y, std::vector<SightLine>& lines) const {
        // The element is written in the list itself. If it were built elsewhere and copied, the copy would
        // wait until the values just written can be read.
        SightLine& line = lines.emplace_back();
        line.x = at.x + x;
        line.y = at.y + y;
        line.place = view.sample;
        line.lens = view.lens_point;
        line.light_before = view.light_before;
        line.set = view.set;
        line.view = view.number;
    }

    /// Decides whether a pixel shows the same surface at two recorded instants. This is so if the object ids
    /// are equal, and if the two inverse depths differ by at most this fraction of the larger one.
    static constexpr float same_depth = 0.02F;
};

/// Number of rays (`lines`) that are traced in one batch. A batch must be large for efficiency, but the data
/// of its rays must fit into the processor's caches.
inline constexpr std::size_t lines_together = 4096;

/// Rays that are samples of the pixels of a tile. They are collected, and then traced together.
class RayBatch {
  public:
    /// Assigns the last ray of lines() to pixel `k` of the tile. Its radiance counts with `weight`.
    void finish(std::size_t k, double weight) {
        pixel_.push_back(static_cast<std::uint16_t>(k));
        weight_.push_back(weight);
    }
    /// The rays. After a ray is appended, `finish` must be called for it.
    [[nodiscard]] std::vector<SightLine>& lines() { return lines_; }
    [[nodiscard]] bool full() const { return lines_.size() >= lines_together; }
    /// Traces the rays, adds their radiance and weight to `sums`, and removes them. `left` tells whether the
    /// highlights are left to rays.
    void trace(const PatchViews& set, LeftToRays left, LightSums& sums);

  private:
    std::vector<SightLine> lines_;
    std::vector<std::uint16_t> pixel_;
    std::vector<double> weight_;
    std::vector<std::array<float, 3>> radiance_;
};

/// The samples of views that rays replace in a tile.
class RaySamples {
  public:
    LeftToRays left = LeftToRays::unsure;  ///< what rays replace in the tile
    bool parents_too = false;  ///< whether the samples of surfaces that reflect or transmit are rays
    /// Numbers of view samples (what a single view shows in a single pixel) that show a mirror or glass with
    /// separately drawn reflections or refractions. `with_sure_trees` counts only those that need no ray,
    /// because all these reflections and refractions are recorded accurately.
    std::size_t with_trees = 0, with_sure_trees = 0;
    LightSums sum{};  ///< of the traced radiance
    /// For each pixel: bits that tell which colours of the current view are replaced by a ray. A view blends
    /// the colours of at most two recorded instants. Bit 0 stands for the first of them, and bit 1 for the
    /// second.
    std::array<std::uint8_t, SeenTile::pixels> uses{};

    /// Schedules rays for pixels of the tile, and removes these pixels' recorded colours. A pixel gets a ray
    /// - if the directly visible surface is uncertain, for example because an edge crosses it
    /// - if it shows a mirror or glass, and objects move or `parents_too` is true
    /// - if rays replace the whole tile (whole_tile)
    void set_aside(const ShownView& shown, LightSums& recorded);
    /// Schedules a ray for each pixel that shows a mirror or glass whose reflections or refractions are
    /// missing or inaccurate. `trees` holds the reflections and refractions recorded at the view's instant
    /// `u` (0 or 1).
    void set_aside_trees(const ShownView& shown, std::size_t u, const TreeSums& trees, LightSums& recorded);
    /// Returns whether rays replace all samples of views in the tile.
    [[nodiscard]] bool whole_tile() const { return left != LeftToRays::unsure; }
    [[nodiscard]] bool full() const { return rays_.full(); }
    /// Traces the rays and adds them to `sum`.
    void trace(const PatchViews& set) { rays_.trace(set, left, sum); }

  private:
    void find_doubtful(const ShownView& shown, bool parents);
    /// Replaces the share `weight` of one view's sample by a ray.
    void leave_to_rays(const ShownView& shown, int x, int y, double weight, LightSums& recorded);

    PixelList doubtful_;
    RayBatch rays_;
};

/// Measures the error of recorded colours by tracing check rays in selected pixels. The radiance of each
/// check ray is compared with the colour that one view shows in the pixel. The rays do not change the image.
class CheckedSamples {
  public:
    std::vector<PixelCheck> sums;  ///< per pixel

    void begin(const PatchField& field, const PatchViews& set, const TilePlace& at);
    /// Stores the colours of a view in the pixels that PatchViews::checked selects for this view. Call it
    /// once for each recorded instant that the view uses.
    /// - `number`: index of the view in PatchViews::views
    /// - `u`: index of the recorded instant, 0 or 1
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
