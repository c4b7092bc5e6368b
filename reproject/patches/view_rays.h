// The samples of views that are traced as rays. Rays replace samples whose colours the records do not
// determine, and check others.
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

/// The surfaces that a view shows in the pixels of a tile. Each use of the view has its own SeenTile; a use
/// is one recorded instant that is reprojected to the view.
struct ShownView {
    const PatchField& field;
    const PatchView& view;
    TilePlace at;
    SeenTile* seen = nullptr;  ///< one or two, per use

    [[nodiscard]] const PatchMesh& mesh(std::size_t u) const {
        return *field.instants[view.uses[u].instant].primary;
    }
    /// The object that use `u` shows in pixel `k`.
    [[nodiscard]] std::uint32_t id(std::size_t u, std::size_t k) const {
        return mesh(u).id_of(seen[u].texel[k]);
    }
    /// Weight of use `u` (a recorded instant of the view) in pixel `k`. If both uses show the same surface,
    /// their colours are blended. Otherwise only the nearer surface counts, unless `has_vague_outline`.
    [[nodiscard]] double share(std::size_t u, std::size_t k) const {
        const std::size_t o = 1 - u;
        if (seen[o].texel[k] == SeenTile::no_texel) return 1;
        const float mine = seen[u].inverse_z[k], other = seen[o].inverse_z[k];
        if (id(u, k) == id(o, k) && std::abs(mine - other) <= same_depth * std::max(mine, other))
            return view.uses[u].share;
        const std::size_t nearer = mine > other || (mine == other && u == 0) ? u : o;
        return has_vague_outline(nearer, k) ? nearer != u : nearer == u;
    }
    /// Whether the surface that use `u` shows in pixel `k` ends in a leaf that the view magnifies to more
    /// than a pixel, while the other use has recorded this part of the object at a larger size. The other use
    /// then shows more exactly where the object ends.
    [[nodiscard]] bool has_vague_outline(std::size_t u, std::size_t k) const;
    /// Whether the lens transmits light to the pixel (x, y) of the tile.
    [[nodiscard]] bool passes(int x, int y) const {
        return !view.passes || view.passes(at.x - field.x + x, at.y - field.y + y);
    }
    /// The ray of the view through the pixel (x, y) of the tile.
    [[nodiscard]] SightLine line(int x, int y) const {
        return {at.x + x, at.y + y, view.sample, view.lens_point, view.light_before, view.set, view.number};
    }

    /// Two instants show the same surface in a pixel if the ids are equal and the inverse depths differ by at
    /// most this relative amount.
    static constexpr float same_depth = 0.02F;
};

/// Number of rays that are traced together: large enough for efficient batches, and small enough for the
/// caches.
inline constexpr std::size_t lines_together = 4096;

/// View samples of a tile that are replaced by rays.
class RaySamples {
  public:
    LeftToRays left = LeftToRays::unsure;  ///< what rays replace in the tile
    bool parents_too = false;              ///< the samples of surfaces that reflect or transmit are rays
    /// Number of samples whose reflected and transmitted light set_aside_trees has tested, and number of
    /// those whose light the records determine.
    std::size_t with_trees = 0, with_sure_trees = 0;
    LightSums sum{};                                    ///< of the traced radiance
    std::array<std::uint8_t, SeenTile::pixels> uses{};  ///< per pixel, bits of the view's uses that are rays

    /// If the records do not determine the directly visible surface of a view's sample, a ray replaces the
    /// sample. With `parents_too`, or if something moves, rays also replace the samples of surfaces that
    /// reflect or transmit: a reflection moves differently from its mirror. `recorded` receives the sums of
    /// all other samples.
    void set_aside(const ShownView& shown, LightSums& recorded);
    /// If the records do not determine the reflected or transmitted light of a view's sample, a ray replaces
    /// the sample. `u`: index of the view's use (recorded instant).
    void set_aside_trees(const ShownView& shown, std::size_t u, const TreeSums& trees, LightSums& recorded);
    /// Whether all view samples of the tile are rays.
    [[nodiscard]] bool whole_tile() const { return left != LeftToRays::unsure; }
    [[nodiscard]] bool full() const { return lines_.size() >= lines_together; }
    /// Traces the rays and adds them to `sum`.
    void trace(const PatchViews& set);

  private:
    /// Lists the pixels in which the view's sample may have to become a ray. Most pixels are excluded by a
    /// test that is faster than that of set_aside.
    void find_doubtful(const ShownView& shown, bool parents);
    /// Replaces the share `weight` of one view's sample by a ray.
    void leave_to_rays(const ShownView& shown, int x, int y, double weight, LightSums& recorded);

    PixelList doubtful_;
    std::vector<SightLine> lines_;
    std::vector<std::uint16_t> pixel_;
    std::vector<double> weight_;
    std::vector<std::array<float, 3>> radiance_;
};

/// View samples of a tile that are compared with check rays.
class CheckedSamples {
  public:
    std::vector<PixelCheck> sums;  ///< per pixel

    void begin(const PatchField& field, const PatchViews& set, const TilePlace& at);
    /// Stores the radiance of the records for those samples of a view that are checked, unless rays replace
    /// them. Called for each use of the view in turn. `number`: index of the view in its set. `trees`: null
    /// if no reflected or transmitted node is drawn.
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
    /// `noted_` has an element per checked pixel of the view, `recorded_` one per line: the share of the
    /// sample that comes from records (w), and their radiance times this share. The rest of the sample is a
    /// ray.
    std::vector<glm::dvec4> noted_, recorded_;
    std::vector<std::array<float, 3>> radiance_;
};

}  // namespace postlens
