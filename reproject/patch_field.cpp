#include "reproject/patch_field.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/progress.h"
#include "core/threads.h"
#include "reproject/patches/border_reach.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patch_reach.h"
#include "reproject/patches/patch_sweep.h"
#include "reproject/patches/seen_light.h"
#include "reproject/patches/tree_sums.h"

namespace postlens {
namespace {

/// Largest relative difference of 1/z' at which two instants with equal ids show the same surface.
constexpr float same_depth = 0.02F;

using Bins = std::vector<std::vector<std::uint32_t>>;  ///< per tile, patches that some view may show there

/// The patches of a tile, in drawing order.
struct TilePatches {
    PatchMesh mesh;
    std::vector<PatchReach> reach;
    std::vector<std::uint32_t> motion_class;
};

/// The patches [begin, end) of one path, the sequence of reflections and transmissions from the eye.
struct Chain {
    NodePath path;
    std::size_t begin = 0, end = 0;
};

/// The buffers of one thread.
struct Workplace {
    SeenTile seen[2];
    std::vector<TilePatches> primary, deeper;  ///< per instant
    std::vector<std::vector<Chain>> chains;    ///< per instant, the chains of `deeper`
    std::vector<NodePath> paths;               ///< paths of all chains
    WantedPixels wanted;
    LightSums sum{};
    PixelList with_children;
    TreeSums trees;
    TileViews views;
    std::vector<double> light;
    std::array<std::uint8_t, SeenTile::pixels> touched{};
    /// View samples that are replaced by rays: lines of sight, their pixels and weights, and the traced
    /// radiance.
    struct Traced {
        bool whole_tile = false;
        std::vector<SightLine> lines;
        std::vector<std::uint16_t> pixel;
        std::vector<double> weight;
        std::vector<std::array<float, 3>> radiance;
        LightSums sum{};
        std::array<std::uint8_t, SeenTile::pixels>
            uses{};  ///< per pixel, bits of the view's uses that are rays
    } traced;
    /// View samples that are compared with a ray: their pixels per view, with repetitions; their lines of
    /// sight and the radiance of the records; the residuals, ray minus records.
    struct Checked {
        std::vector<std::vector<std::uint16_t>> pixels;
        std::vector<std::uint32_t> views;
        std::vector<SightLine> lines;
        std::vector<std::uint16_t> pixel;
        std::vector<glm::dvec3> recorded;
        std::vector<std::array<float, 3>> radiance;
        std::vector<PixelCheck> sums;
    } checked;
};

/// Number of lines of sight that are traced together: enough for efficient batches, few enough for the
/// caches.
constexpr std::size_t lines_together = 4096;

/// Number of views that are drawn between tests for cancellation, as a tile with thousands of views takes
/// long.
constexpr std::size_t views_between_looks = 64;

class Field {
  public:
    explicit Field(const PatchField& field)
        : field_(field), columns_(tiles(field.width)), rows_(tiles(field.height)) {
        for (const PatchViews& set : field.sets) {
            total_.push_back(0);
            for (const PatchView& v : set.views) {
                total_.back() += v.weight;
                farthest_px_ = glm::max(farthest_px_, glm::abs(v.lens.lens_px));
                farthest_shift_px_ =
                    std::max(farthest_shift_px_,
                             glm::length(v.lens.inverse_focus_per_m * v.lens.lens_px + v.lens.offset_px));
            }
        }
        farthest_px_ = glm::max(farthest_px_, field.lens_reach_px);
        for (std::size_t i = 0; i < field.instants.size(); ++i) {
            marks_.emplace_back();
            if (marked()) {
                for (const Sheet& s : field.instants[i].primary->sheets->sheets)
                    marks_[i].push_back(field.class_marks[field.motion_class(s.key.id)]);
            }
            primary_.push_back(sorted(*field.instants[i].primary, i));
            deeper_.push_back(field.instants[i].deeper != nullptr ? sorted(*field.instants[i].deeper, i)
                                                                  : Bins());
            trees_ = trees_ || field.instants[i].deeper != nullptr;
        }
        if (std::none_of(field.sets.begin(), field.sets.end(),
                         [](const PatchViews& set) { return set.rays != nullptr; }))
            return;
        for (std::size_t i = 0; i < field.instants.size(); ++i)
            borders_.emplace_back(*field.instants[i].primary, field, i);
    }

    void draw(std::span<PatchPicture> out) {
        const std::size_t tiles = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
        Progress progress("views", tiles);
        parallel_for(tiles, [&](std::size_t tile) {
            thread_local std::unique_ptr<Workplace> w;
            if (!w) w = std::make_unique<Workplace>();
            draw_tile(tile, *w, out);
            progress.advance();
        });
    }

  private:
    static int tiles(int px) { return (px + SeenTile::edge - 1) / SeenTile::edge; }

    /// Per tile, the patches that reach it in some view, sorted by path, so that parents come first, and then
    /// nearest first, so that hidden pixels fail the depth test early.
    [[nodiscard]] Bins sorted(const PatchMesh& mesh, std::size_t instant) const {
        const PatchSweep sweep(field_);
        std::vector<RasterRect> swept(mesh.patches.size());
        parallel_for(
            swept.size(),
            [&](std::size_t i) {
                const Patch& p = mesh.patches[i];
                swept[i] = sweep.of(mesh, p, instant);
                // A moving object is also assigned to the tiles where it was recorded, as pixels there get
                // its mark (mark_recorded).
                PatchPlace recorded;
                if (marked() && marks_[instant][p.sheet] != 0 && place_patch(mesh, p, {}, {}, recorded))
                    swept[i].add(covered(p, recorded));
            },
            256);
        Bins bins(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
        const auto tile_of = [](double px, int first, int count) {
            return static_cast<int>(
                std::clamp(std::floor((px - first) / SeenTile::edge), -1.0, static_cast<double>(count)));
        };
        for (std::uint32_t i = 0; i < swept.size(); ++i) {
            const RasterRect& r = swept[i];
            if (!(r.x_min <= r.x_max && r.y_min <= r.y_max)) continue;
            const int x0 = std::max(0, tile_of(r.x_min - 1, field_.x, columns_)),
                      x1 = std::min(columns_ - 1, tile_of(r.x_max + 1, field_.x, columns_)),
                      y0 = std::max(0, tile_of(r.y_min - 1, field_.y, rows_)),
                      y1 = std::min(rows_ - 1, tile_of(r.y_max + 1, field_.y, rows_));
            for (int y = y0; y <= y1; ++y) {
                for (int x = x0; x <= x1; ++x)
                    bins[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>(x)]
                        .push_back(i);
            }
        }
        parallel_for(bins.size(), [&](std::size_t t) {
            std::stable_sort(bins[t].begin(), bins[t].end(), [&](std::uint32_t a, std::uint32_t b) {
                const Patch &p = mesh.patches[a], &q = mesh.patches[b];
                const std::uint32_t path = mesh.sheet(p).key.path.bits(),
                                    other = mesh.sheet(q).key.path.bits();
                if (path != other) return path < other;
                return mesh.planes[p.first_plane].value > mesh.planes[q.first_plane].value;
            });
        });
        return bins;
    }

    void draw_tile(std::size_t tile, Workplace& w, std::span<PatchPicture> out) const {
        const int x0 = static_cast<int>(tile) % columns_ * SeenTile::edge,
                  y0 = static_cast<int>(tile) / columns_ * SeenTile::edge;
        const TilePlace at{field_.x + x0, field_.y + y0, std::min(SeenTile::edge, field_.width - x0),
                           std::min(SeenTile::edge, field_.height - y0)};
        if (marked() && !has_wanted_marks(tile)) return;
        bool gathered = false;
        const int edge = field_.piece_px;
        for (std::size_t set = 0; set < field_.sets.size(); ++set) {
            const auto& wanted = field_.sets[set].wanted;
            for (int y = 0; y < at.height; y += edge) {
                for (int x = 0; x < at.width; x += edge) {
                    const TilePlace piece{at.x + x, at.y + y, std::min(edge, at.width - x),
                                          std::min(edge, at.height - y)};
                    if (wanted && !wanted(x0 + x, y0 + y, piece.width, piece.height)) continue;
                    if (!gathered) gather(tile, w);
                    gathered = true;
                    draw_set(set, piece, w, out[field_.sets[set].picture]);
                }
            }
        }
    }

    void draw_set(std::size_t number, TilePlace at, Workplace& w, PatchPicture& out) const {
        const PatchViews& set = field_.sets[number];
        const int x0 = at.x - field_.x, y0 = at.y - field_.y;
        fill_pixels(at, w.sum, {});
        fill_pixels(at, w.traced.uses, 0);
        if (set.rays != nullptr) fill_pixels(at, w.traced.sum, {});
        w.traced.whole_tile = set.left_to_rays && set.left_to_rays(x0, y0);
        if (set.checked) begin_checks(set, at, w.checked);
        if (trees_) w.trees.begin(w.paths, at);
        if (marked()) mark_recorded(at, w);
        const bool lights = set.lights != nullptr && set.lights->reach(x0, y0, at.width, at.height);
        if (lights) {
            w.views.x = x0;
            w.views.y = y0;
            w.views.width = at.width;
            w.views.height = at.height;
            const PatchView::Use& use = set.views.front().uses.front();
            w.views.patches = use.motions.empty() ? &w.primary[use.instant].mesh : nullptr;
            w.views.inverse_z.resize(set.views.size() * TileViews::view);
            w.views.texel.resize(set.views.size() * TileViews::view);
        }
        for (std::size_t i = 0; i < set.views.size(); ++i) {
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
        if (set.rays != nullptr) trace(set, w.traced);
        if (set.checked) {
            check(set, w.checked);
            for (int y = 0; y < at.height; ++y) {
                std::copy_n(w.checked.sums.begin() + y * SeenTile::edge, at.width,
                            out.checks.begin() + (y0 + y) * static_cast<std::ptrdiff_t>(field_.width) + x0);
            }
        }
        store(at, total_[number], lights, set.rays != nullptr, w, out);
    }

    static void trace(const PatchViews& set, Workplace::Traced& t) {
        t.radiance.resize(t.lines.size());
        set.rays->trace(t.lines, set.less, t.radiance);
        for (std::size_t i = 0; i < t.lines.size(); ++i) {
            auto& sum = t.sum[t.pixel[i]];
            for (std::size_t c = 0; c < 3; ++c) sum[c] += t.weight[i] * static_cast<double>(t.radiance[i][c]);
            sum[3] += t.weight[i];
        }
        t.lines.clear();
        t.pixel.clear();
        t.weight.clear();
    }

    void begin_checks(const PatchViews& set, const TilePlace& at, Workplace::Checked& c) const {
        c.pixels.resize(set.views.size());
        for (auto& of_view : c.pixels) of_view.clear();
        c.sums.resize(SeenTile::pixels);
        fill_pixels(at, c.sums, {});
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                c.views.clear();
                set.checked(at.x - field_.x + x, at.y - field_.y + y, c.views);
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                c.sums[k].views = static_cast<std::uint32_t>(c.views.size());
                for (const std::uint32_t view : c.views)
                    c.pixels[view].push_back(static_cast<std::uint16_t>(k));
            }
        }
    }

    /// Line of sight of a view in a pixel.
    [[nodiscard]] static SightLine line_of(const PatchView& v, const TilePlace& at, int x, int y) {
        return {at.x + x, at.y + y, v.sample, v.lens_point, v.light_before, v.set, v.number};
    }

    /// Stores the radiance of the records for checked view samples, unless they are rays.
    void note_checked(const PatchView& v, std::size_t view, std::size_t u, const TilePlace& at, bool trees,
                      Workplace& w) const {
        const PatchMesh& mesh = *field_.instants[v.uses[u].instant].primary;
        for (const std::uint16_t k : w.checked.pixels[view]) {
            const std::uint32_t texel = w.seen[u].texel[k];
            // If both recorded instants show the same surface, only the first is compared with a ray.
            if (texel == SeenTile::no_texel || (w.traced.uses[k] >> u & 1U) != 0) continue;
            if (v.uses.size() == 2 && (u == 1 || share(v, u, k, w) == 0)) continue;
            const int x = k % SeenTile::edge, y = k / SeenTile::edge;
            if (v.passes && !v.passes(at.x - field_.x + x, at.y - field_.y + y)) continue;
            w.checked.lines.push_back(line_of(v, at, x, y));
            w.checked.pixel.push_back(k);
            w.checked.recorded.push_back(glm::dvec3(mesh.light(texel)) +
                                         (trees ? w.trees.light(k) : glm::dvec3(0)));
        }
    }

    static void check(const PatchViews& set, Workplace::Checked& c) {
        c.radiance.resize(c.lines.size());
        set.rays->trace(c.lines, set.less, c.radiance);
        for (std::size_t i = 0; i < c.lines.size(); ++i) {
            PixelCheck& of = c.sums[c.pixel[i]];
            ++of.rays;
            for (std::size_t n = 0; n < 3; ++n) {
                of.sum[n] += static_cast<double>(c.radiance[i][n]) - c.recorded[i][static_cast<int>(n)];
            }
        }
        c.lines.clear();
        c.pixel.clear();
        c.recorded.clear();
    }

    /// Replaces the share `weight` of a view sample by a ray.
    void leave_to_rays(const PatchView& v, const TilePlace& at, int x, int y, double weight,
                       Workplace& w) const {
        const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
        if (v.passes && !v.passes(at.x - field_.x + x, at.y - field_.y + y)) {
            w.sum[k][3] += weight;
            return;
        }
        w.traced.lines.push_back(line_of(v, at, x, y));
        w.traced.pixel.push_back(static_cast<std::uint16_t>(k));
        w.traced.weight.push_back(weight);
    }

    /// Whether the records determine the primary surface that use `u` of a view (a recorded instant
    /// reprojected to it) shows in a pixel.
    [[nodiscard]] bool sure(const PatchView& v, std::size_t u, std::size_t k, const Workplace& w) const {
        const std::uint32_t texel = w.seen[u].texel[k];
        return texel != SeenTile::no_texel && !w.seen[u].may_be_hidden(k) &&
               !field_.instants[v.uses[u].instant].primary->unsure(texel);
    }

    /// Replaces view samples by rays if the records do not determine their primary surface.
    void set_aside(const PatchView& v, const TilePlace& at, Workplace& w) const {
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                bool sure_of_all = !w.traced.whole_tile;
                for (std::size_t u = 0; u < v.uses.size(); ++u) sure_of_all = sure_of_all && sure(v, u, k, w);
                if (sure_of_all && v.uses.size() == 2)
                    sure_of_all = id_seen(v, 0, k, w) == id_seen(v, 1, k, w);
                w.traced.uses[k] = 0;
                if (sure_of_all) continue;
                leave_to_rays(v, at, x, y, v.weight, w);
                for (std::size_t u = 0; u < v.uses.size(); ++u) w.seen[u].texel[k] = SeenTile::no_texel;
            }
        }
    }

    /// Replaces view samples from one recorded instant by rays if the records do not determine their
    /// reflected or transmitted nodes.
    void set_aside_trees(const PatchView& v, std::size_t u, const TilePlace& at, Workplace& w) const {
        const PatchMesh& mesh = *field_.instants[v.uses[u].instant].primary;
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                const std::uint32_t texel = w.seen[u].texel[k];
                if (texel == SeenTile::no_texel || mesh.drawn_children(texel) == 0 || w.trees.sure(k))
                    continue;
                if (v.uses.size() == 1) {
                    leave_to_rays(v, at, x, y, v.weight, w);
                    w.seen[u].texel[k] = SeenTile::no_texel;
                    continue;
                }
                const double weight = v.weight * share(v, u, k, w);
                if (weight > 0) leave_to_rays(v, at, x, y, weight, w);
                w.traced.uses[k] |= static_cast<std::uint8_t>(1U << u);
            }
        }
    }

    [[nodiscard]] bool marked() const { return !field_.class_marks.empty(); }

    [[nodiscard]] bool has_wanted_marks(std::size_t tile) const {
        for (std::size_t i = 0; i < primary_.size(); ++i) {
            for (const std::uint32_t p : primary_[i][tile]) {
                if ((marks_[i][field_.instants[i].primary->patches[p].sheet] & field_.wanted_marks) != 0)
                    return true;
            }
        }
        return false;
    }

    /// Marks pixels where an instant's records show a moving object: their colour differs from that of the
    /// views.
    void mark_recorded(const TilePlace& at, Workplace& w) const {
        fill_pixels(at, w.touched, 0);
        for (std::size_t i = 0; i < w.primary.size(); ++i) {
            const PatchMesh& mesh = w.primary[i].mesh;
            for (const Patch& p : mesh.patches) {
                const std::uint8_t mark = marks_[i][p.sheet];
                if (mark == 0) continue;
                const Sheet& s = mesh.sheet(p);
                for (int y = p.y; y < p.y + p.height; ++y) {
                    for (int x = p.x; x < p.x + p.width; ++x) {
                        const int px = s.x + x - at.x, py = s.y + y - at.y;
                        if (px < 0 || py < 0 || px >= at.width || py >= at.height) continue;
                        const int cell = y * s.width + x, pixel = py * SeenTile::edge + px;
                        if (mesh.sheets->fine[s.first_cell + static_cast<std::size_t>(cell)] !=
                            SheetNode::none)
                            w.touched[static_cast<std::size_t>(pixel)] |= mark;
                    }
                }
            }
        }
    }

    /// Marks pixels where a view sees a moving object or nothing.
    void mark_seen(const PatchView& v, const TilePlace& at, Workplace& w) const {
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                bool any = false;
                for (std::size_t u = 0; u < v.uses.size(); ++u) {
                    const std::uint32_t texel = w.seen[u].texel[k];
                    if (texel == SeenTile::no_texel) continue;
                    any = true;
                    const std::size_t i = v.uses[u].instant;
                    w.touched[k] |= marks_[i][field_.instants[i].primary->sheets->texels[texel].sheet()];
                }
                if (!any) w.touched[k] = 0xFF;
            }
        }
    }

    /// Collects the patches that any view of any set may show in a tile.
    void gather(std::size_t tile, Workplace& w) const {
        w.primary.resize(field_.instants.size());
        w.deeper.resize(field_.instants.size());
        w.chains.assign(field_.instants.size(), {});
        w.paths.clear();
        for (std::size_t i = 0; i < field_.instants.size(); ++i)
            gather(*field_.instants[i].primary, primary_[i][tile], w.primary[i]);
        if (trees_) gather_chains(tile, w);
    }

    // Collects all paths that may occur in the tile, so that views without them count as unknown.
    void gather_chains(std::size_t tile, Workplace& w) const {
        for (std::size_t i = 0; i < field_.instants.size(); ++i) {
            if (field_.instants[i].deeper == nullptr) continue;
            gather(*field_.instants[i].deeper, deeper_[i][tile], w.deeper[i]);
            const PatchMesh& mesh = w.deeper[i].mesh;
            std::vector<Chain>& chains = w.chains[i];
            for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
                const NodePath path = mesh.sheet(mesh.patches[p]).key.path;
                if (chains.empty() || chains.back().path != path) {
                    w.paths.push_back(path);
                    chains.push_back({path, p, p});
                }
                chains.back().end = p + 1;
            }
        }
        if (!w.paths.empty()) {
            w.paths.push_back(NodePath().child(NodePath::Bounce::reflected));
            w.paths.push_back(NodePath().child(NodePath::Bounce::transmitted));
        }
    }

    /// Copies a tile's patches to contiguous memory, as every view reads all patches of the tile.
    void gather(const PatchMesh& mesh, const std::vector<std::uint32_t>& bin, TilePatches& out) const {
        out.mesh.sheets = mesh.sheets;
        out.mesh.overlap_px = mesh.overlap_px;
        out.mesh.patches.clear();
        out.mesh.planes.clear();
        out.reach.clear();
        out.motion_class.clear();
        for (const std::uint32_t i : bin) {
            Patch p = mesh.patches[i];
            if (field_.motion_class)
                out.motion_class.push_back(static_cast<std::uint32_t>(motion_class_of(field_, mesh, p)));
            out.reach.push_back(patch_reach(mesh, p, farthest_px_, farthest_shift_px_));
            const auto planes = mesh.planes.begin() + p.first_plane;
            p.first_plane = static_cast<std::uint32_t>(out.mesh.planes.size());
            out.mesh.planes.insert(out.mesh.planes.end(), planes,
                                   planes + static_cast<std::ptrdiff_t>(mesh.sheets->values));
            out.mesh.patches.push_back(p);
        }
    }

    /// Tests patches without motion against a tile, for one view.
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

    /// The motion of each patch of a tile in one view.
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
        const TilePatches& patches = w.deeper[use.instant];
        const Motions motions(use, patches);
        const PatchMesh& mesh = patches.mesh;
        const ViewReach reach(v.lens, at);
        PatchPlace place;
        for (const Chain& chain : w.chains[use.instant]) {
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

    void draw_view(const PatchViews& set, std::size_t view, bool lights, const TilePlace& at,
                   Workplace& w) const {
        const PatchView& v = set.views[view];
        // Where all view samples of a tile are rays, only highlights need the reprojected surfaces.
        const bool drawn = lights || !w.traced.whole_tile;
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            if (drawn)
                draw_primary(v, v.uses[u], at, w.primary[v.uses[u].instant], w.seen[u]);
            else
                w.seen[u].clear(at);
        }
        if (marked()) mark_seen(v, at, w);
        if (lights) {
            const auto to = static_cast<std::ptrdiff_t>(view * TileViews::view);
            for (std::ptrdiff_t row = 0; row < at.height * SeenTile::edge; row += SeenTile::edge) {
                std::copy_n(w.seen[0].inverse_z.begin() + row, at.width,
                            w.views.inverse_z.begin() + to + row);
                std::copy_n(w.seen[0].texel.begin() + row, at.width, w.views.texel.begin() + to + row);
            }
        }
        const bool rays = set.rays != nullptr;
        if (rays) {
            if (!w.traced.whole_tile) {
                for (std::size_t u = 0; u < v.uses.size(); ++u)
                    borders_[v.uses[u].instant].mark(v, v.uses[u], at, w.seen[u]);
            }
            set_aside(v, at, w);
        }
        const bool trees = trees_ && w.trees.any() && !w.traced.whole_tile;
        // If both recorded instants show the same surface in a pixel, their colours are blended; otherwise
        // only the nearer surface counts.
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            if (trees) draw_deeper(v, v.uses[u], at, w.seen[u], w);
            if (rays && trees) set_aside_trees(v, u, at, w);
            if (set.checked) note_checked(v, view, u, at, trees, w);
            if (v.uses.size() == 1 && !v.passes) {
                add_all(v, at, trees, w);
            } else {
                add_some(v, u, at, trees, w);
            }
        }
        if (rays && w.traced.lines.size() >= lines_together) trace(set, w.traced);
        if (set.checked && w.checked.lines.size() >= lines_together) check(set, w.checked);
    }

    /// Adds all pixels of a view that is reprojected from a single recorded instant to the sums.
    void add_all(const PatchView& v, const TilePlace& at, bool trees, Workplace& w) const {
        const PatchMesh& mesh = *field_.instants[v.uses[0].instant].primary;
        add_seen_light(mesh.sheets->texels, w.seen[0], at.width, at.height, v.weight, w.sum, w.with_children);
        for (const std::size_t k : w.with_children)
            add_children(mesh, w.seen[0].texel[k], k, v.weight, trees, w);
    }

    /// Adds a view's pixels from recorded instant `u` to the sums, where the view has two recorded instants
    /// or the lens blocks its light in some pixels.
    void add_some(const PatchView& v, std::size_t u, const TilePlace& at, bool trees, Workplace& w) const {
        const PatchMesh& mesh = *field_.instants[v.uses[u].instant].primary;
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                const std::uint32_t texel = w.seen[u].texel[k];
                if (texel == SeenTile::no_texel || (w.traced.uses[k] >> u & 1U) != 0) continue;
                const double weight = v.uses.size() == 1 ? v.weight : v.weight * share(v, u, k, w);
                if (weight == 0) continue;
                w.sum[k][3] += weight;
                if (v.passes && !v.passes(at.x - field_.x + x, at.y - field_.y + y)) continue;
                const Texel& t = mesh.sheets->texels[texel];
                w.sum[k][0] += weight * static_cast<double>(t.r);
                w.sum[k][1] += weight * static_cast<double>(t.g);
                w.sum[k][2] += weight * static_cast<double>(t.b);
                if (t.children() != 0) add_children(mesh, texel, k, weight, trees, w);
            }
        }
    }

    /// Adds the light that a texel (one recorded colour of a primary surface) shows by reflection and
    /// transmission.
    static void add_children(const PatchMesh& mesh, std::uint32_t texel, std::size_t k, double weight,
                             bool trees, Workplace& w) {
        const std::array<float, 3> following = mesh.following(texel);
        for (std::size_t c = 0; c < 3; ++c) w.sum[k][c] += weight * static_cast<double>(following[c]);
        if (trees && mesh.drawn_children(texel) != 0) w.trees.add(k, weight);
    }

    [[nodiscard]] double share(const PatchView& v, std::size_t u, std::size_t k, const Workplace& w) const {
        const std::size_t o = 1 - u;
        if (w.seen[o].texel[k] == SeenTile::no_texel) return 1;
        const float mine = w.seen[u].inverse_z[k], other = w.seen[o].inverse_z[k];
        if (id_seen(v, u, k, w) == id_seen(v, o, k, w) &&
            std::abs(mine - other) <= same_depth * std::max(mine, other))
            return v.uses[u].share;
        return mine > other || (mine == other && u == 0) ? 1 : 0;
    }

    [[nodiscard]] std::uint32_t id_seen(const PatchView& v, std::size_t u, std::size_t k,
                                        const Workplace& w) const {
        return field_.instants[v.uses[u].instant].primary->id_of(w.seen[u].texel[k]);
    }

    void store(const TilePlace& at, double total, bool lights, bool rays, Workplace& w,
               PatchPicture& out) const {
        const int x0 = at.x - field_.x, y0 = at.y - field_.y;
        if (trees_) w.trees.end_views();
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                const std::size_t p =
                    static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(field_.width) +
                    static_cast<std::size_t>(x0 + x);
                if (marked()) out.touched[p] = w.touched[k];
                const double recorded = w.sum[k][3], traced = rays ? w.traced.sum[k][3] : 0,
                             known = recorded + traced;
                if (rays) out.traced[p] = static_cast<float>(traced / total);
                out.unknown[p] = static_cast<float>(std::max(0.0, 1 - known / total));
                if (known <= 0) {
                    out.unknown[p] = 1;
                    continue;
                }
                std::array<double, 3> sum{w.sum[k][0], w.sum[k][1], w.sum[k][2]};
                if (trees_ && recorded > 0) {
                    const TreeSums::Unknown below = w.trees.sum_up(k, recorded, sum);
                    out.unknown_below[p] = static_cast<float>(below.all / total);
                    out.guessed_below[p] = static_cast<float>(below.guessed / total);
                }
                if (traced > 0) {
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += w.traced.sum[k][c];
                }
                float* rgb = out.image.pixel(x0 + x, y0 + y);
                for (std::size_t c = 0; c < 3; ++c) {
                    rgb[c] = static_cast<float>(sum[c] / known);
                    if (lights) rgb[c] += static_cast<float>(w.light[Lights::values * k + c]);
                }
                if (lights) out.light_square[p] = static_cast<float>(w.light[Lights::values * k + 3]);
            }
        }
    }

    const PatchField& field_;
    int columns_, rows_;
    std::vector<double> total_;     ///< weight of each set's views
    glm::dvec2 farthest_px_{0};     ///< per axis, largest lens point, as LensShift::lens_px
    double farthest_shift_px_ = 0;  ///< largest shift of a point at infinity in a view, px
    bool trees_ = false;
    std::vector<std::vector<std::uint8_t>> marks_;  ///< per instant and primary sheet
    std::vector<Bins> primary_, deeper_;            ///< per instant
    std::vector<BorderReach> borders_;              ///< per instant; empty without rays
};

}  // namespace

PatchPicture::PatchPicture(int width, int height) : image(width, height) {
    unknown.assign(image.rgb.size() / 3, 1);
    unknown_below.assign(unknown.size(), 0);
    guessed_below.assign(unknown.size(), 0);
}

void patch_field(const PatchField& field, std::span<PatchPicture> out) {
    for (const PatchViews& set : field.sets) {
        PatchPicture& picture = out[set.picture];
        if (set.lights != nullptr) picture.light_square.resize(picture.unknown.size());
        if (set.rays != nullptr) picture.traced.resize(picture.unknown.size());
        if (set.checked) picture.checks.resize(picture.unknown.size());
        if (!field.class_marks.empty()) picture.touched.resize(picture.unknown.size());
    }
    Field(field).draw(out);
}

}  // namespace postlens
