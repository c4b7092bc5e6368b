#include "reproject/patch_field.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "core/new_memory.h"
#include "core/progress.h"
#include "core/threads.h"
#include "reproject/patches/border_reach.h"
#include "reproject/patches/extra_rays.h"
#include "reproject/patches/highlight_rays.h"
#include "reproject/patches/motion_marks.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patch_reach.h"
#include "reproject/patches/seen_light.h"
#include "reproject/patches/tile_patches.h"
#include "reproject/patches/tree_sums.h"
#include "reproject/patches/view_rays.h"

namespace postlens {
namespace {

/// The buffers of one thread.
struct Workplace {
    SeenTile seen[2];
    GatheredTile patches;
    bool gathered = false;  ///< whether `patches` contains the patches of the current piece
    /// Whether the current piece (the square of the image that is being drawn) shows too many surfaces in
    /// mirrors or through glass to reproject them. Then tracing rays is faster. Empty until this is
    /// determined for the piece.
    std::optional<bool> is_crowded;
    bool draws_trees = false;  ///< whether reflected and transmitted patches of the piece are drawn
    WantedPixels wanted;
    LightSums sum{};
    PixelList with_children;
    TreeSums trees;
    TileViews views;
    std::vector<double> light;
    MotionMarks::Touched touched{};
    RaySamples rays;
    ExtraRays extra;
    LightSums of_extra{};
    CheckedSamples checked;
    CheckedHighlights checked_highlights;
};

/// A tile may have thousands of views (images for one lens point and instant). After every 64 views, the
/// program checks whether the user has cancelled.
constexpr std::size_t views_between_looks = 64;

/// Number of views (images for one lens point and instant) in a trial. If the records determine the
/// reflections and refractions accurately in fewer than half of the trial's pixels that show mirrors or
/// glass, rays compute all colours of these in the later views.
constexpr std::size_t views_of_trial = 8;

class Field {
  public:
    explicit Field(const PatchField& field) : field_(field), marks_(field), bins_(field, marks_) {
        for (const PatchViews& set : field.sets) {
            total_.push_back(0);
            for (const PatchView& v : set.views) total_.back() += v.weight;
        }
        const auto needs_border = [](const PatchViews& set) {
            return set.rays != nullptr || std::any_of(set.views.begin(), set.views.end(),
                                                      [](const PatchView& v) { return v.moves(); });
        };
        if (field.recorded_end == field.recorded_begin ||
            std::none_of(field.sets.begin(), field.sets.end(), needs_border))
            return;
        for (std::size_t i = 0; i < field.instants.size(); ++i)
            borders_.emplace_back(*field.instants[i].primary, field, i);
    }

    void draw(std::span<PatchPicture> out) {
        const int tiles = bins_.columns() * bins_.rows();
        // A few tiles often take most of the time. So each tile is divided into smaller tasks.
        const int along = SeenTile::edge / field_.piece_px, per_tile = along * along;
        const auto tasks = static_cast<std::size_t>(tiles) * static_cast<std::size_t>(per_tile);
        Progress progress("views", tasks);
        parallel_for(tasks, [&](std::size_t task) {
            thread_local std::unique_ptr<Workplace> w;
            if (!w) w = std::make_unique<Workplace>();
            const int tile = static_cast<int>(task) / per_tile, piece = static_cast<int>(task) % per_tile;
            draw_piece(static_cast<std::size_t>(tile), piece % along * field_.piece_px,
                       piece / along * field_.piece_px, *w, out);
            progress.advance();
        });
    }

  private:
    /// Draws a piece of the image: a square whose upper left corner is (x, y), in px from the corner of its
    /// tile (64 px square of the image). `out` receives the mean colours of all views (images for one lens
    /// point and instant).
    void draw_piece(std::size_t tile, int x, int y, Workplace& w, std::span<PatchPicture> out) const {
        const int x0 = static_cast<int>(tile) % bins_.columns() * SeenTile::edge + x,
                  y0 = static_cast<int>(tile) / bins_.columns() * SeenTile::edge + y;
        const TilePlace piece{field_.x + x0, field_.y + y0, std::min(field_.piece_px, field_.width - x0),
                              std::min(field_.piece_px, field_.height - y0)};
        if (piece.width <= 0 || piece.height <= 0) return;
        if (marks_.any() && !has_wanted_marks(tile)) return;
        const TilePart rect{x, x + piece.width, y, y + piece.height};
        w.gathered = false;
        w.is_crowded.reset();
        for (std::size_t set = 0; set < field_.sets.size(); ++set) {
            const auto& wanted = field_.sets[set].wanted;
            if (wanted && !wanted(x0, y0, piece.width, piece.height)) continue;
            gather(tile, rect, field_.sets[set].rays, w);
            draw_set(set, piece, w, out[field_.sets[set].picture]);
        }
    }

    void gather(std::size_t tile, const TilePart& rect, const SightRays* rays, Workplace& w) const {
        if (!w.gathered) bins_.gather(tile, rect, w.patches);
        w.gathered = true;
        if (rays != nullptr && bins_.trees() && !w.is_crowded)
            w.is_crowded = bins_.has_more_deeper(tile, rect, rays->patches_per_ray() * rect.pixels());
        w.draws_trees = bins_.trees() && (rays == nullptr || !*w.is_crowded);
        if (w.draws_trees && w.patches.paths.empty()) bins_.gather_chains(tile, rect, w.patches);
    }

    void draw_set(std::size_t number, TilePlace at, Workplace& w, PatchPicture& out) const {
        const PatchViews& set = field_.sets[number];
        const int x0 = at.x - field_.x, y0 = at.y - field_.y;
        fill_pixels(at, w.sum, {});
        fill_pixels(at, w.rays.uses, 0);
        if (set.rays != nullptr) fill_pixels(at, w.rays.sum, {});
        w.rays.left = set.left_to_rays ? set.left_to_rays(x0, y0) : LeftToRays::unsure;
        w.rays.parents_too = bins_.trees() && !w.draws_trees;
        w.rays.with_trees = w.rays.with_sure_trees = 0;
        if (set.checked) w.checked.begin(field_, set, at);
        if (w.draws_trees) w.trees.begin(w.patches.paths, at);
        if (marks_.any()) {
            fill_pixels(at, w.touched, 0);
            for (std::size_t i = 0; i < w.patches.primary.size(); ++i)
                marks_.mark_recorded(i, w.patches.primary[i].mesh, at, w.touched);
        }
        const bool lights = set.lights != nullptr && w.rays.left != LeftToRays::samples_and_lights &&
                            set.lights->reach(x0, y0, at.width, at.height);
        if (lights) {
            w.views.x = x0;
            w.views.y = y0;
            w.views.width = at.width;
            w.views.height = at.height;
            const PatchView::Use& use = set.views.front().uses.front();
            w.views.patches = use.motions.empty() ? &w.patches.primary[use.instant].mesh : nullptr;
            w.views.inverse_z.resize(set.views.size() * TileViews::view);
            w.views.texel.resize(set.views.size() * TileViews::view);
        }
        for (std::size_t i = 0; i < set.views.size(); ++i) {
            if (i == views_of_trial && 2 * w.rays.with_sure_trees < w.rays.with_trees)
                w.rays.parents_too = true;
            at.sample = set.views[i].sample;
            if (i % views_between_looks == 0) throw_if_interrupted();
            draw_view(set, i, lights, at, w);
        }
        if (lights) {
            w.light.resize(Lights::values * SeenTile::pixels);
            for (int y = 0; y < at.height; ++y)
                std::fill_n(
                    w.light.begin() + y * static_cast<std::ptrdiff_t>(Lights::values * SeenTile::edge),
                    Lights::values * static_cast<std::size_t>(at.width), 0);
            set.lights->add(w.views, w.light);
        }
        if (set.rays != nullptr) w.rays.trace(set);
        fill_pixels(at, w.of_extra, {});
        if (set.extra_rays) w.extra.trace(field_, set, at, w.rays.left, w.of_extra);
        if (set.checked) {
            w.checked.check(set);
            if (set.extra_rays) dilute_checks(at, w);
            const auto copy = [&](const auto& from, auto& to) {
                for (int y = 0; y < at.height; ++y) {
                    std::copy_n(from.begin() + y * SeenTile::edge, at.width,
                                to.begin() + (y0 + y) * static_cast<std::ptrdiff_t>(field_.width) + x0);
                }
            };
            if (lights) {
                w.checked_highlights.check(field_, set, at, w.light, w.checked.sums);
                copy(w.checked_highlights.sums, out.highlight_checks);
            }
            copy(w.checked.sums, out.checks);
        }
        store(at, total_[number], lights, set.rays != nullptr, w, out);
    }

    /// Check rays measure the error of the mean of the view samples. In pixels with additional rays, the
    /// image contains only a part of this error.
    static void dilute_checks(const TilePlace& at, Workplace& w) {
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                const double extra = w.of_extra[k][3], known = w.sum[k][3] + w.rays.sum[k][3];
                if (!(extra > 0)) continue;
                for (float& sum : w.checked.sums[k].sum) sum *= static_cast<float>(known / (known + extra));
            }
        }
    }

    [[nodiscard]] bool has_wanted_marks(std::size_t tile) const {
        for (std::size_t i = 0; i < field_.instants.size(); ++i) {
            if (marks_.any_wanted(i, bins_.primary(i, tile))) return true;
        }
        return false;
    }

    /// Tests quickly whether a static patch (planar part of a surface) misses a tile (square of the image) in
    /// one view, so that it need not be drawn. The view is given by its lens point.
    class ViewReach {
      public:
        ViewReach(const LensShift& lens, const TilePlace& at)
            : q_(lens.lens_px),
              shift_(lens.inverse_focus_per_m * lens.lens_px + lens.offset_px),
              x_(static_cast<float>(at.x)),
              y_(static_cast<float>(at.y)),
              x_end_(static_cast<float>(at.x + at.width)),
              y_end_(static_cast<float>(at.y + at.height)) {}
        [[nodiscard]] bool misses_tile(const PatchReach& patch) const {
            return patch.bounds(q_, shift_).misses(x_, x_end_, y_, y_end_);
        }
        [[nodiscard]] bool misses(const PixelBlocks& blocks, const PatchReach& patch) const {
            const PatchReach::Bounds b = patch.bounds(q_, shift_);
            return !blocks.any_in(b.x0 - x_, b.x1 - x_, b.y0 - y_, b.y1 - y_);
        }

      private:
        glm::vec2 q_, shift_;
        float x_, y_, x_end_, y_end_;
    };

    class Motions {
      public:
        Motions(const PatchView::Use& use, const TilePatches& patches)
            : maps_(use.motions), patches_(patches) {}
        [[nodiscard]] bool still(std::size_t patch) const { return of(patch).identity(); }
        [[nodiscard]] const RasterMap& of(std::size_t patch) const {
            static const RasterMap none;
            return maps_.empty() ? none : maps_[patches_.motion_class[patch]];
        }

      private:
        const std::vector<RasterMap>& maps_;
        const TilePatches& patches_;
    };

    void draw_primary(const PatchView& v, const PatchView::Use& use, const TilePlace& at,
                      const TilePatches& patches, SeenTile& seen) const {
        const ViewReach reach(v.lens, at);
        seen.clear(at);
        PatchPlace place;
        const PatchMesh& mesh = patches.mesh;
        const Motions motions(use, patches);
        for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
            if (motions.still(i) && reach.misses_tile(patches.reach[i])) continue;
            const Patch& patch = mesh.patches[i];
            if (place_patch(mesh, patch, motions.of(i), v.lens, place))
                draw_patch(mesh, patch, place, at, seen);
        }
    }

    void draw_deeper(const PatchView& v, const PatchView::Use& use, const TilePlace& at, const SeenTile& seen,
                     Workplace& w) const {
        const PatchInstant& instant = field_.instants[use.instant];
        w.trees.begin_use(*instant.primary, instant.deeper, seen);
        if (instant.deeper == nullptr) return;
        const TilePatches& patches = w.patches.deeper[use.instant];
        const Motions motions(use, patches);
        const PatchMesh& mesh = patches.mesh;
        const ViewReach reach(v.lens, at);
        PatchPlace place;
        for (const PatchChain& chain : w.patches.chains[use.instant]) {
            SeenTile* out = w.trees.begin_chain(chain.path, w.wanted);
            if (out == nullptr) continue;
            for (std::size_t i = chain.begin; i < chain.end; ++i) {
                if (motions.still(i) && reach.misses(w.wanted.blocks, patches.reach[i])) continue;
                const Patch& patch = mesh.patches[i];
                if (place_patch(mesh, patch, motions.of(i), v.lens, place))
                    draw_patch_in(mesh, patch, place, at, w.wanted, *out);
            }
        }
    }

    /// Removes recorded surfaces from a view (image for one lens point and instant) where an unrecorded
    /// object may hide them. Such an object lies outside the recorded image. But the lens point or the motion
    /// may shift it into the view, where it covers recorded surfaces.
    void leave_out_beyond_border(const PatchView& v, const TilePlace& at, Workplace& w) const {
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            const BorderReach& border = borders_[v.uses[u].instant];
            SeenTile& seen = w.seen[u];
            if (!border.reaches(at)) continue;
            fill_pixels(at, seen.maybe_inverse_z, SeenTile::nothing);
            border.mark(v, v.uses[u], at, seen);
            for (int y = 0; y < at.height; ++y) {
                const std::size_t row = static_cast<std::size_t>(y) * SeenTile::edge;
                for (std::size_t k = row; k < row + static_cast<std::size_t>(at.width); ++k) {
                    if (!seen.may_be_hidden(k)) continue;
                    seen.texel[k] = SeenTile::no_texel;
                    seen.inverse_z[k] = SeenTile::nothing;
                }
            }
        }
    }

    void draw_view(const PatchViews& set, std::size_t view, bool lights, const TilePlace& at,
                   Workplace& w) const {
        const PatchView& v = set.views[view];
        // Whether the directly visible surfaces are drawn in this view. They are not needed in a part of the
        // image whose colours are all computed by rays, unless it contains highlights (`lights`), which
        // nearer surfaces may hide.
        const bool drawn = lights || !w.rays.whole_tile();
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            if (drawn)
                draw_primary(v, v.uses[u], at, w.patches.primary[v.uses[u].instant], w.seen[u]);
            else
                w.seen[u].clear(at);
        }
        if (set.rays == nullptr && !borders_.empty()) leave_out_beyond_border(v, at, w);
        if (marks_.any()) marks_.mark_seen(v, at, w.seen, w.touched);
        if (lights) {
            const auto to = static_cast<std::ptrdiff_t>(view * TileViews::view);
            for (std::ptrdiff_t row = 0; row < at.height * SeenTile::edge; row += SeenTile::edge) {
                std::copy_n(w.seen[0].inverse_z.begin() + row, at.width,
                            w.views.inverse_z.begin() + to + row);
                std::copy_n(w.seen[0].texel.begin() + row, at.width, w.views.texel.begin() + to + row);
            }
        }
        const ShownView shown{field_, v, at, w.seen};
        const bool rays = set.rays != nullptr;
        if (rays) {
            if (!w.rays.whole_tile() && !borders_.empty()) {
                for (std::size_t u = 0; u < v.uses.size(); ++u)
                    borders_[v.uses[u].instant].mark(v, v.uses[u], at, w.seen[u]);
            }
            w.rays.set_aside(shown, w.sum);
        }
        const bool trees = w.draws_trees && w.trees.any() && !w.rays.whole_tile() && !w.rays.parents_too &&
                           !(rays && v.moves());
        // Adds the colours of this view to the sums of the pixels. If the view's instant lies between two
        // recorded ones, `v.uses` contains both. A pixel that shows the same surface at both is a blend of
        // two colours. In other pixels, one surface counts.
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            if (trees) draw_deeper(v, v.uses[u], at, w.seen[u], w);
            if (rays && trees) w.rays.set_aside_trees(shown, u, w.trees, w.sum);
            if (set.checked) w.checked.note(shown, view, u, w.rays, trees ? &w.trees : nullptr);
            if (v.uses.size() == 1 && !v.passes) {
                add_all(v, at, trees, w);
            } else {
                add_some(shown, u, trees, w);
            }
        }
        if (rays && w.rays.full()) w.rays.trace(set);
        if (set.checked && w.checked.full()) w.checked.check(set);
    }

    /// Adds the colours of a view to the sums of its pixels. It is a faster variant of add_some for a view
    /// without vignetting that is reprojected from a single recorded instant.
    void add_all(const PatchView& v, const TilePlace& at, bool trees, Workplace& w) const {
        const PatchMesh& mesh = *field_.instants[v.uses[0].instant].primary;
        add_seen_light(mesh.sheets->texels, w.seen[0], at.width, at.height, v.weight, w.sum, w.with_children);
        for (const std::size_t k : w.with_children)
            add_children(mesh, w.seen[0].texel[k], k, v.weight, trees, w);
    }

    static void add_some(const ShownView& shown, std::size_t u, bool trees, Workplace& w) {
        const PatchView& v = shown.view;
        const TilePlace& at = shown.at;
        const PatchMesh& mesh = shown.mesh(u);
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                const std::uint32_t texel = w.seen[u].texel[k];
                if (texel == SeenTile::no_texel || (w.rays.uses[k] >> u & 1U) != 0) continue;
                const double weight = v.uses.size() == 1 ? v.weight : v.weight * shown.share(u, k);
                if (weight == 0) continue;
                w.sum[k][3] += weight;
                if (!shown.passes(x, y)) continue;
                const Texel& t = mesh.sheets->texels[texel];
                w.sum[k][0] += weight * static_cast<double>(t.r);
                w.sum[k][1] += weight * static_cast<double>(t.g);
                w.sum[k][2] += weight * static_cast<double>(t.b);
                if (t.children() != 0) add_children(mesh, texel, k, weight, trees, w);
            }
        }
    }

    static void add_children(const PatchMesh& mesh, std::uint32_t texel, std::size_t k, double weight,
                             bool trees, Workplace& w) {
        const std::array<float, 3> following = mesh.following(texel);
        for (std::size_t c = 0; c < 3; ++c) w.sum[k][c] += weight * static_cast<double>(following[c]);
        if (trees && mesh.drawn_children(texel) != 0) w.trees.add(k, weight);
    }

    void store(const TilePlace& at, double total, bool lights, bool rays, Workplace& w,
               PatchPicture& out) const {
        const int x0 = at.x - field_.x, y0 = at.y - field_.y;
        if (w.draws_trees) w.trees.end_views();
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                const std::size_t p =
                    static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(field_.width) +
                    static_cast<std::size_t>(x0 + x);
                if (marks_.any()) out.touched[p] = w.touched[k];
                const double recorded = w.sum[k][3], traced = rays ? w.rays.sum[k][3] : 0,
                             known = recorded + traced;
                if (rays) out.traced[p] = static_cast<float>(traced / total);
                out.unknown[p] = static_cast<float>(std::max(0.0, 1 - known / total));
                if (known <= 0) {
                    out.unknown[p] = 1;
                    continue;
                }
                std::array<double, 3> sum{w.sum[k][0], w.sum[k][1], w.sum[k][2]};
                if (w.draws_trees && recorded > 0) {
                    out.unknown_below[p] = static_cast<float>(w.trees.sum_up(k, recorded, sum) / total);
                }
                if (traced > 0) {
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += w.rays.sum[k][c];
                }
                float* rgb = out.image.pixel(x0 + x, y0 + y);
                for (std::size_t c = 0; c < 3; ++c) {
                    rgb[c] = static_cast<float>((sum[c] + w.of_extra[k][c]) / (known + w.of_extra[k][3]));
                    if (lights) rgb[c] += static_cast<float>(w.light[Lights::values * k + c]);
                }
                if (lights) out.light_square[p] = static_cast<float>(w.light[Lights::values * k + 3]);
            }
        }
    }

    const PatchField& field_;
    MotionMarks marks_;
    PatchBins bins_;
    std::vector<double> total_;         ///< weight of each set's views
    std::vector<BorderReach> borders_;  ///< per instant; empty without rays and motion
};

}  // namespace

PatchPicture::PatchPicture(int width, int height) : image(width, height) {
    unknown.assign(image.rgb.size() / 3, 1);
    unknown_below.assign(unknown.size(), 0);
}

void PatchPicture::clear() {
    for (std::vector<float>* values : {&image.rgb, &unknown_below, &traced, &light_square})
        std::fill(values->begin(), values->end(), 0.0F);
    std::fill(unknown.begin(), unknown.end(), 1.0F);
    std::fill(touched.begin(), touched.end(), std::uint8_t{0});
}

void patch_field(const PatchField& field, std::span<PatchPicture> out) {
    for (const PatchViews& set : field.sets) {
        PatchPicture& picture = out[set.picture];
        if (set.lights != nullptr) picture.light_square.resize(picture.unknown.size());
        if (set.rays != nullptr) picture.traced.resize(picture.unknown.size());
        if (set.checked) resize_by_all(picture.checks, picture.unknown.size());
        if (set.checked && set.lights != nullptr)
            resize_by_all(picture.highlight_checks, picture.unknown.size());
        if (!field.class_marks.empty()) picture.touched.resize(picture.unknown.size());
    }
    Field(field).draw(out);
}

}  // namespace postlens
