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

/// The surfaces that one view (image for one lens point and instant) shows in a tile. `seen` has one
/// SeenTile, or two if the view blends two recorded instants.
struct ShownView {
    const PatchField& field;
    const PatchView& view;
    TilePlace at;
    SeenTile* seen = nullptr;  ///< one or two, per use

    [[nodiscard]] const PatchMesh& mesh(std::size_t u) const {
        return *field.instants[view.uses[u].instant].primary;
    }
    /// Returns the id of the object that pixel `k` shows at a recorded instant. A view may blend two recorded
    /// instants; `u` (0 or 1) selects one of them.
    [[nodiscard]] std::uint32_t id(std::size_t u, std::size_t k) const {
        return mesh(u).id_of(seen[u].texel[k]);
    }
    /// Returns the weight of the colour from recorded instant `u` (0 or 1) in pixel `k`. Of two different
    /// surfaces, only the nearer counts, or the farther if the nearer one has_vague_outline.
    [[nodiscard]] double share(std::size_t u, std::size_t k) const {
        const std::size_t o = 1 - u;
        if (seen[o].texel[k] == SeenTile::no_texel) return 1;
        const float mine = seen[u].inverse_z[k], other = seen[o].inverse_z[k];
        if (id(u, k) == id(o, k) && std::abs(mine - other) <= same_depth * std::max(mine, other))
            return view.uses[u].share;
        const std::size_t nearer = mine > other || (mine == other && u == 0) ? u : o;
        return has_vague_outline(nearer, k) ? nearer != u : nearer == u;
    }
    /// A view may blend two recorded instants. Returns whether instant `u` (0 or 1) has the less precise
    /// outline of the object in pixel `k`. The object appears smaller at this instant, so fewer samples
    /// recorded its outline.
    [[nodiscard]] bool has_vague_outline(std::size_t u, std::size_t k) const;
    /// Returns whether light through the lens point reaches pixel (x, y) of the tile. Otherwise, vignetting
    /// blocks it.
    [[nodiscard]] bool passes(int x, int y) const {
        return !view.passes || view.passes(at.x - field.x + x, at.y - field.y + y);
    }
    /// Writes each member in place: a line that is built first and then copied stalls the processor, because
    /// it loads values that it has only just stored.
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
    /// `with_trees`: number of samples that show a mirror or glass. `with_sure_trees`: number of those that
    /// need no ray, because their reflections and refractions are recorded accurately.
    std::size_t with_trees = 0, with_sure_trees = 0;
    LightSums sum{};  ///< of the traced radiance
    /// A view's colour comes from one recorded instant or is blended from two. Bits 0 and 1 of each pixel
    /// stand for these instants. A set bit means that a ray replaces the instant's colour.
    std::array<std::uint8_t, SeenTile::pixels> uses{};

    /// Schedules rays for the pixels in which the directly visible surface is uncertain, for example at an
    /// edge. If objects move, also schedules rays for all pixels with mirrors or glass, because a reflection
    /// moves differently from its mirror.
    void set_aside(const ShownView& shown, LightSums& recorded);
    /// Selects the pixels with mirrors or glass whose reflections or refractions are missing or inaccurate,
    /// and adds a ray for each to the list. `trees` holds these reflections and refractions, as seen at
    /// recorded instant `u` (0 or 1).
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

/// Measures the error of recorded colours. Compares them with traced rays (check rays) in selected pixels,
/// separately for single lens points and instants. The rays do not change the image.
class CheckedSamples {
  public:
    std::vector<PixelCheck> sums;  ///< per pixel

    void begin(const PatchField& field, const PatchViews& set, const TilePlace& at);
    /// Stores the recorded colours of a view (image for one lens point and instant) in the pixels that
    /// PatchViews::checked selects. Later, `check` compares them with rays. Call once for each recorded
    /// instant `u` of the view.
    /// - `number`: index of the view in PatchViews::views
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
