// Computes how much of each highlight's light reaches the pixels of a tile (square of the image) past the
// surfaces in front of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "focus/light_field/field_highlights.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/sheets/sample_surfaces.h"

namespace postlens {
namespace {

/// A surface hides a highlight only if it is nearer by at least about 2 %: its inverse depth must exceed the
/// highlight's inverse depth times this factor.
constexpr float nearer = 1.02F;
/// Limits the time to test, in one tile, whether nearer surfaces hide highlights. The tests may take as long
/// as drawing the tile from as many lens points as the image has, or from least_drawn lens points if these
/// are more.
constexpr std::size_t least_drawn = 64;
/// Smallest cost of a visibility test, relative to the cost of drawing the whole tile from one lens point. A
/// test draws the surfaces in front of a highlight in only a part of the tile. Even if this part is tiny, it
/// takes time to find these surfaces.
constexpr double least_cost = 0.1;
/// Positions in a pixel, in px, at which the visibility of highlights is tested. Each row and each column of
/// a 4 x 4 grid over the pixel contains one position.
constexpr std::array<glm::dvec2, 4> drawn_samples{glm::dvec2(0.375, 0.125), glm::dvec2(0.875, 0.375),
                                                  glm::dvec2(0.125, 0.625), glm::dvec2(0.625, 0.875)};
/// Whether occluders hide a group of nearby highlights is tested at four points around the group's centre.
/// These are the points' offsets, in standard deviations of the highlights' positions.
constexpr std::array<glm::dvec2, 4> spread_places{glm::dvec2(1.3416, -0.4472), glm::dvec2(0.4472, 1.3416),
                                                  glm::dvec2(-0.4472, -1.3416), glm::dvec2(-1.3416, 0.4472)};
/// Limit for computing an occluder's shadow only once for a group of highlights. The shadow lies at a
/// slightly different position in the blur of each highlight. If the standard deviation of these positions is
/// below this limit, in px, the difference is ignored.
constexpr double told_apart_px = 0.3;

}  // namespace

class FieldHighlights::OverViews final : public Lights {
  public:
    OverViews(const FieldHighlights& of, const std::vector<LensViewPoint>& views, int set,
              std::vector<double> instants)
        : of_(of), views_(views), instants_(std::move(instants)), set_(set), all_(views.size()) {
        std::iota(all_.begin(), all_.end(), 0U);
    }

    [[nodiscard]] bool reach(int x, int y, int width, int height) const override {
        return of_.reach(x, y, width, height);
    }
    void add(const TileViews& views, std::vector<double>& light) const override;
    [[nodiscard]] std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const override {
        return of_.reaching(x, y, width, height);
    }
    void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
             std::vector<Line>& lines) const override {
        of_.aim(x, y, sources, seed, count, lines);
    }

  private:
    using Nearest = std::vector<std::array<std::uint32_t, 3>>;
    struct Asked {
        int edge = 0;
        Nearest nearest;
        std::vector<std::uint32_t> all;
    };
    /// Divides the lens into a grid of `edge` x `edge` cells, and finds the three lens points nearest to each
    /// cell's centre. The value away2(i) is added to the squared distance of the lens point i, in squared
    /// lens radii. It increases with the point's difference in time.
    template <typename Away>
    [[nodiscard]] static Nearest nearest_of(const std::vector<LensViewPoint>& views, int edge,
                                            const Away& away2);
    /// Tables for finding the views (images from single lens points) that tell whether a highlight's light
    /// passes through a certain part of the lens. The lens is divided into a grid of cells. For each cell, a
    /// table lists the three nearest lens points, whose views are used.
    struct Tables {
        Asked always;
        std::vector<Asked> timed;  ///< per span of the exposure; empty if no highlight moves
    };
    [[nodiscard]] Tables make_tables() const;
    void lay_timed(std::vector<Asked>& timed) const;
    [[nodiscard]] static std::size_t cell_of(const glm::dvec2& q, int edge);
    [[nodiscard]] const Asked& asked(const Source& s) const {
        // Makes `tables_` once. Meanwhile, other threads may wait in call_once. make_tables() must not use a
        // parallel loop: such a loop could wait for the other threads, while they wait for the tables (a
        // deadlock).
        std::call_once(made_, [this] { tables_ = make_tables(); });
        if (s.u < 0 || tables_.timed.empty()) return tables_.always;
        return tables_.timed[static_cast<std::size_t>(std::clamp(s.u * spans, 0.0, spans - 1.0))];
    }
    [[nodiscard]] std::vector<GroupHere> groups_in(const TileViews& views) const;
    void draw_shares(const Group& g, const PatchMesh& patches, int samples, Part& part) const;
    void ask_views(const Group& g, const TileViews& views, Part& part) const;
    /// A cache of results of seen_share_beside(), the visible fraction of a highlight's light in a pixel. The
    /// key is a pixel and a square of 1/4 x 1/4 px. All highlights whose centres lie in this square share the
    /// result.
    using SharesBeside = std::map<std::tuple<std::size_t, int, int>, double>;
    void add(const Source& s, const Part* part, const TileViews& views, SharesBeside& beside,
             std::vector<double>& light) const;
    [[nodiscard]] double seen_share(const Source& s, const TileViews& views, std::size_t pixel,
                                    const glm::dvec2& at) const;
    [[nodiscard]] double seen_share_beside(const Source& s, const TileViews& views, std::size_t pixel,
                                           const glm::dvec2& corner) const;
    [[nodiscard]] bool sees(const Source& s, const TileViews& views, std::size_t view,
                            std::size_t pixel) const {
        const std::size_t k = view * TileViews::view + pixel;
        return of_.sees(s, views.texel[k], views.inverse_z[k]);
    }

    static constexpr int table_edge = 64, timed_edge = 32;  ///< cells across the lens
    static constexpr double table_reach = 1.1;              ///< lens radii
    /// Number of equal intervals into which the exposure is divided, for moving highlights. Each interval has
    /// its own table, which lists for each part of the lens the lens points that are nearest in position and
    /// time.
    static constexpr int spans = 16;
    /// Factor that converts a difference in time to a distance on the lens. For each moving highlight, views
    /// are needed that are near both in their lens point and in their instant. The whole exposure counts as
    /// much as this distance, in lens radii.
    static constexpr double lens_radii_of_open = 2;
    /// Special value of Part::share, normally the visible fraction of a group of highlights in a pixel. It
    /// means that only some views of a static scene see the group there. The highlights of the group may then
    /// differ, so the fraction is computed for each of them.
    static constexpr float differs = -1;
    /// Numbers of views (images from single lens points) that decide how much of a sharp highlight is visible
    /// in a pixel. These are the views whose sample in the pixel lies closest to the highlight: the fraction
    /// 1 / beside_of_views of all views, but at least least_beside.
    static constexpr std::size_t beside_of_views = 8, least_beside = 4;
    static constexpr std::size_t least_of_span = 8;  ///< smallest number of views in the list `all` of a span
    const FieldHighlights& of_;
    const std::vector<LensViewPoint>& views_;
    std::vector<double> instants_;
    int set_;
    std::vector<std::uint32_t> all_;  ///< indices of all views
    mutable std::once_flag made_;
    mutable Tables tables_;
};

std::unique_ptr<Lights> FieldHighlights::over(const std::vector<LensViewPoint>& views, int set,
                                              const std::vector<double>& instants) const {
    return std::make_unique<OverViews>(*this, views, set, instants);
}

template <typename Away>
FieldHighlights::OverViews::Nearest FieldHighlights::OverViews::nearest_of(
    const std::vector<LensViewPoint>& views, int edge, const Away& away2) {
    Nearest out(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge));
    std::vector<std::pair<double, std::uint32_t>> by_row;
    for (std::size_t row = 0; row < static_cast<std::size_t>(edge); ++row) {
        const auto of_cell = [edge](std::size_t i) {
            return (2 * (static_cast<double>(i) + 0.5) / edge - 1) * table_reach;
        };
        const double q_y = of_cell(row);
        by_row.clear();
        for (std::uint32_t v = 0; v < views.size(); ++v) {
            const double d = views[v].lens.y - q_y;
            by_row.emplace_back(d * d, v);
        }
        std::sort(by_row.begin(), by_row.end());
        for (std::size_t x = 0; x < static_cast<std::size_t>(edge); ++x) {
            const double q_x = of_cell(x);
            auto& to = out[row * static_cast<std::size_t>(edge) + x];
            std::array<std::pair<double, std::uint32_t>, std::tuple_size_v<Nearest::value_type>> best;
            best.fill({HUGE_VAL, 0});
            for (const auto& [d_y2, v] : by_row) {
                if (d_y2 > best.back().first) break;
                const double d_x = views[v].lens.x - q_x;
                std::pair<double, std::uint32_t> candidate{d_x * d_x + d_y2 + away2(v), v};
                if (!(candidate < best.back())) continue;
                for (auto& b : best) {
                    if (candidate < b) std::swap(candidate, b);
                }
            }
            for (std::size_t i = 0; i < to.size(); ++i)
                to[i] = std::isinf(best[i].first) ? best[0].second : best[i].second;
        }
    }
    return out;
}

FieldHighlights::OverViews::Tables FieldHighlights::OverViews::make_tables() const {
    Tables out;
    out.always = {table_edge, nearest_of(views_, table_edge, [](std::size_t) { return 0.0; }), all_};
    const bool any_moves =
        std::any_of(of_.sources_.begin(), of_.sources_.end(), [](const Source& s) { return s.u >= 0; });
    if (any_moves && instants_.size() == views_.size()) lay_timed(out.timed);
    return out;
}

void FieldHighlights::OverViews::lay_timed(std::vector<Asked>& timed) const {
    for (int span = 0; span < spans; ++span) {
        const double middle = (span + 0.5) / spans;
        const auto away2 = [&](std::size_t v) {
            const double away = lens_radii_of_open * (instants_[v] - middle);
            return away * away;
        };
        std::vector<std::uint32_t> order(views_.size());
        std::iota(order.begin(), order.end(), 0U);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return away2(a) < away2(b); });
        order.resize(std::min(order.size(), std::max(least_of_span, order.size() / spans)));
        timed.push_back({timed_edge, nearest_of(views_, timed_edge, away2), std::move(order)});
    }
}

bool FieldHighlights::reach(int x, int y, int width, int height) const {
    if (sources_.empty()) return false;
    const RasterWindow part{x, x + width, y, y + height};
    return any_near(x, y, [&](const Reach& r) { return meet(r.pixels, part); });
}

bool FieldHighlights::sees(const Source& s, std::uint32_t texel, float inverse_z) const {
    if (texel == SeenTile::no_texel) return true;
    const Texel& t = sheets_.primary.texels[texel];
    const SheetKey& seen = sheets_.primary.sheets[t.sheet()].key;
    if (s.key.path.bits() == 0) return seen.id == s.key.id || inverse_z <= nearer * s.inverse_z;
    // A highlight in a mirror or behind glass counts as visible if the mirror or glass is visible. This is an
    // approximation, because surfaces between the mirror (or glass) and the highlight may hide it.
    if ((t.children() & child_bit(s.key.path.bounce(0))) == 0) return false;
    return s.key.path.depth() > 1 || seen.id == s.key.parent_id;
}

std::vector<FieldHighlights::GroupHere> FieldHighlights::OverViews::groups_in(const TileViews& views) const {
    std::vector<GroupHere> out;
    for (const std::uint32_t i : of_.reaching(views.x, views.y, views.width, views.height)) {
        if (out.empty() || of_.sources_[out.back().sources.front()].group != of_.sources_[i].group)
            out.emplace_back();
        out.back().sources.push_back(i);
    }
    // Chooses the brightest groups of highlights. For these, nearer surfaces are drawn to find out exactly
    // whether they hide the highlights. The total cost of these tests in a tile is limited, so all other
    // groups use the views, which are less exact.
    const auto group = [&](const GroupHere& here) -> const Group& {
        return of_.groups_[of_.sources_[here.sources.front()].group];
    };
    std::vector<std::size_t> order;
    double samples = 0;
    const auto cost = [&](const GroupHere& here) {
        const Group& g = group(here);
        const int width = std::min(g.x_end, views.x + views.width) - std::max(g.x_begin, views.x),
                  height = std::min(g.y_end, views.y + views.height) - std::max(g.y_begin, views.y);
        return std::max(least_cost, static_cast<double>(width) * height / SeenTile::pixels);
    };
    for (std::size_t n = 0; n < out.size(); ++n) {
        const Source& s = group(out[n]).middle;
        if (views.patches == nullptr || s.by_all || s.key.path.bits() != 0) continue;
        order.push_back(n);
        samples += cost(out[n]);
    }
    auto left = static_cast<double>(std::max(least_drawn, views_.size()));
    const int each = samples * drawn_samples.size() <= left ? static_cast<int>(drawn_samples.size()) : 1;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return group(out[a]).light > group(out[b]).light; });
    for (const std::size_t n : order) {
        left -= each * cost(out[n]);
        if (left < 0) break;
        out[n].samples = each;
    }
    return out;
}

void FieldHighlights::OverViews::draw_shares(const Group& g, const PatchMesh& patches, int samples,
                                             Part& part) const {
    const Source& s = g.middle;
    const int width = part.x1 - part.x0, height = part.y1 - part.y0;
    constexpr int next_row = 89;
    // `turn` shifts the positions in each pixel, in px, at which occluders are drawn to test whether they
    // hide the highlights. Each group of highlights and each set of lens points has another shift, so that
    // the errors of these tests average out in the image.
    const glm::dvec2 turn = static_cast<double>(g.column + next_row * g.row) *
                                glm::dvec2(0.7548776662466927, 0.5698402909980532) +
                            glm::dvec2(set_) * glm::dvec2(0.38196601125010515, 0.6180339887498949);
    const double x0 = of_.window_.x_begin + part.x0, y0 = of_.window_.y_begin + part.y0;
    const auto z = static_cast<double>(s.inverse_z);
    std::vector<PlacedPatch> before;
    const auto find_before = [&](const glm::dvec2& from_middle_px) {
        before.clear();
        const PointRays rays{s.at + from_middle_px + glm::dvec2(of_.window_.x_begin, of_.window_.y_begin),
                             of_.geometry_.gain_px * of_.geometry_.aperture_radius_m * s.lens_from_px,
                             of_.geometry_.inverse_focus_per_m};
        for (const Patch& patch : patches.patches) {
            // Skips a surface that lies completely behind the highlight, because it cannot hide the
            // highlight. The surfaces are not sorted by depth, so later ones may lie in front of the
            // highlight.
            if (patches.sheet(patch).inverse_z_max <= nearer * s.inverse_z) continue;
            place_nearer(patches, patch, rays, z, static_cast<double>(nearer) * z, before);
        }
        std::erase_if(before, [&](const PlacedPatch& p) {
            const RasterRect r = covered(p.patch, p.place);
            return !(r.x_max + 1 >= x0 && r.x_min - 1 <= x0 + width && r.y_max + 1 >= y0 &&
                     r.y_min - 1 <= y0 + height);
        });
    };
    find_before({0, 0});
    if (before.empty()) {
        part.share.fill(1);
        return;
    }
    double shadow_px = 0;  // displacement of a shadow per pixel of displacement of its highlight
    const double s_per_m = of_.geometry_.inverse_focus_per_m;
    for (const PlacedPatch& p : before) {
        const auto of_patch = static_cast<double>(patches.sheet(p.patch).inverse_z_max);
        shadow_px = std::max(shadow_px,
                             std::abs((of_patch - s_per_m) / (of_patch - static_cast<double>(s.inverse_z))));
    }
    const bool apart = samples > 1 && shadow_px * std::max(g.spread_px.x, g.spread_px.y) > told_apart_px;
    SeenTile seen;
    for (int n = 0; n < samples; ++n) {
        const TilePlace place{
            of_.window_.x_begin + part.x0, of_.window_.y_begin + part.y0, width, height,
            glm::fract(turn + (samples == 1 ? glm::dvec2(0.5) : drawn_samples[static_cast<std::size_t>(n)]))};
        if (apart) find_before(spread_places[static_cast<std::size_t>(n)] * g.spread_px);
        seen.clear(place);
        for (const PlacedPatch& p : before) draw_patch(patches, p.patch, p.place, place, seen);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const std::size_t k =
                    static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
                if (n == 0) part.share[k] = 0;
                part.share[k] +=
                    of_.sees(s, seen.texel[k], seen.inverse_z[k]) ? 1.0F / static_cast<float>(samples) : 0;
            }
        }
    }
}

void FieldHighlights::OverViews::ask_views(const Group& g, const TileViews& views, Part& part) const {
    for (int y = part.y0; y < part.y1; ++y) {
        for (int x = part.x0; x < part.x1; ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y - views.y) * TileViews::row +
                                      static_cast<std::size_t>(x - views.x);
            const double share = seen_share(g.middle, views, pixel, {x + 0.5, y + 0.5});
            part.share[static_cast<std::size_t>(y - part.y0) * SeenTile::edge +
                       static_cast<std::size_t>(x - part.x0)] =
                share > 0 && share < 1 && views.patches != nullptr ? differs : static_cast<float>(share);
        }
    }
}

void FieldHighlights::OverViews::add(const TileViews& views, std::vector<double>& light) const {
    Part part;
    for (const GroupHere& here : groups_in(views)) {
        const Group& g = of_.groups_[of_.sources_[here.sources.front()].group];
        SharesBeside beside;
        const bool shared = here.samples > 0 || (g.middle.by_all && g.middle.u < 0);
        if (shared) {
            part.x0 = std::max(views.x, g.x_begin);
            part.x1 = std::min(views.x + views.width, g.x_end);
            part.y0 = std::max(views.y, g.y_begin);
            part.y1 = std::min(views.y + views.height, g.y_end);
            if (here.samples > 0) {
                draw_shares(g, *views.patches, here.samples, part);
            } else {
                ask_views(g, views, part);
            }
        }
        for (const std::uint32_t i : here.sources)
            add(of_.sources_[i], shared ? &part : nullptr, views, beside, light);
    }
}

void FieldHighlights::OverViews::add(const Source& s, const Part* part, const TileViews& views,
                                     SharesBeside& beside, std::vector<double>& light) const {
    const Kernel& kernel = of_.kernel_of(s);
    const int y0 = std::max(views.y, s.y + kernel.y_begin),
              y1 = std::min(views.y + views.height, s.y + kernel.y_end());
    for (int y = y0; y < y1; ++y) {
        const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
        const int x0 = std::max(views.x, s.x + row.x_begin),
                  x1 = std::min(views.x + views.width, s.x + row.x_end);
        for (int x = x0; x < x1; ++x) {
            const double value = kernel.at(row, x - s.x);
            const std::size_t pixel = static_cast<std::size_t>(y - views.y) * TileViews::row +
                                      static_cast<std::size_t>(x - views.x);
            double share = value;
            if (part != nullptr) {
                const float of_part = part->share[static_cast<std::size_t>(y - part->y0) * SeenTile::edge +
                                                  static_cast<std::size_t>(x - part->x0)];
                if (of_part == differs) {
                    const glm::ivec2 square(glm::floor(s.at * 4.0));
                    const auto [known, is_new] = beside.try_emplace({pixel, square.x, square.y}, 0);
                    if (is_new) known->second = seen_share_beside(s, views, pixel, glm::dvec2(x, y));
                    share *= known->second;
                } else {
                    share *= static_cast<double>(of_part);
                }
            } else {
                share *= seen_share(s, views, pixel, {x + 0.5, y + 0.5});
            }
            double* to = light.data() + values * pixel;
            for (std::size_t c = 0; c < 3; ++c) to[c] += share * static_cast<double>(s.rgb[c]);
            to[3] += share * s.square;
        }
    }
}

std::size_t FieldHighlights::OverViews::cell_of(const glm::dvec2& q, int edge) {
    const auto cell = [edge](double v) {
        return static_cast<std::size_t>(std::clamp((v / table_reach + 1) / 2 * edge, 0.0, edge - 1.0));
    };
    return cell(q.y) * static_cast<std::size_t>(edge) + cell(q.x);
}

double FieldHighlights::OverViews::seen_share(const Source& s, const TileViews& views, std::size_t pixel,
                                              const glm::dvec2& at) const {
    const glm::dvec2 q = s.lens_from_px * (at - s.at);
    const auto share = [&](const auto& of) {
        int seen = 0;
        for (const std::uint32_t v : of) seen += sees(s, views, v, pixel) ? 1 : 0;
        return static_cast<double>(seen) / static_cast<double>(of.size());
    };
    if (s.by_all && s.u < 0) return share(all_);
    const Asked& from = asked(s);
    return s.by_all ? share(from.all) : share(from.nearest[cell_of(q, from.edge)]);
}

/// Returns the fraction of a sharp highlight's light that is visible in one pixel. A view (image from one
/// lens point) has one sample in this pixel, at its own position. Among the views whose samples lie nearest
/// to the highlight, the result is the fraction that see it.
/// - `corner`: upper left corner of the pixel
double FieldHighlights::OverViews::seen_share_beside(const Source& s, const TileViews& views,
                                                     std::size_t pixel, const glm::dvec2& corner) const {
    std::vector<std::pair<double, std::uint32_t>> by_distance;
    by_distance.reserve(views_.size());
    for (std::uint32_t v = 0; v < views_.size(); ++v) {
        // Where light through the lens point of this view arrives.
        const glm::dvec2 arrives = glm::clamp(s.at + s.px_from_lens * views_[v].lens - corner, 0.0, 1.0),
                         away = arrives - views_[v].place;
        by_distance.emplace_back(glm::dot(away, away), v);
    }
    const std::size_t count =
        std::min(by_distance.size(), std::max(least_beside, by_distance.size() / beside_of_views));
    std::nth_element(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(count) - 1,
                     by_distance.end());
    std::size_t seen = 0;
    for (std::size_t i = 0; i < count; ++i) seen += sees(s, views, by_distance[i].second, pixel) ? 1 : 0;
    return static_cast<double>(seen) / static_cast<double>(count);
}

}  // namespace postlens
