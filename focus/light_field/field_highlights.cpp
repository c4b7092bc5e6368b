#include "focus/light_field/field_highlights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include "core/threads.h"
#include "focus/light_field/merged_highlights.h"
#include "focus/light_field/sharp_kernel.h"
#include "focus/responses/depth_levels.h"
#include "reproject/patches/patches.h"

namespace postlens {
namespace {

/// A highlight with a smaller blur radius than this, in px, appears in the same pixel from all lens points.
/// So the visible fraction of its light in this pixel is the fraction of all views (images from single lens
/// points) that see it. For larger blur, only the views from a part of the lens count.
constexpr double seen_by_all_px = 0.5;
/// Area limits for sharp highlights, whose blur radius is below 2 px. A sharp highlight is spread by its blur
/// kernel only if it is small: its surface's bright area, within a square of 16 x 16 px, must be below the
/// limit, in px^2. The limit is `sharp_px2` if nothing hides the highlight, and `small_px2` for a mirror
/// image that may be partly hidden.
constexpr float sharp_px2 = 64, small_px2 = 4;
/// Highlights of one surface in the same small square are merged into one light source. A moving highlight
/// needs one light source for each instant at which it is drawn. To limit their number, the squares are wider
/// if there are many instants:
/// - 1/8 px up to moments_of_eighths instants
/// - 1/4 px up to moments_of_quarters instants
/// - 1/2 px above
constexpr int moments_of_eighths = 32, moments_of_quarters = 128;
/// Largest number of light sources for all moving highlights together. A moving highlight needs one light
/// source for each instant at which it is drawn. If all of them would exceed most_moving, each highlight is
/// drawn at fewer instants, but at no fewer than least_moments.
constexpr std::size_t most_moving = std::size_t{1} << 21U;
constexpr int least_moments = 8;
/// Radiance of white. If a blur kernel spreads a highlight, it spreads only the part of its radiance above
/// this value. The part below stays on the surface, and is shown by the images from single lens points, like
/// all other light.
constexpr float white = 1;
/// A static highlight is spread by a blur kernel only if its radiance exceeds white by at least this value,
/// in some colour channel. Dimmer light is shown by the views (images from single lens points), like all
/// other light, because it causes little noise.
constexpr float least_radiance = 1;
/// Width, in px, of squares of the image. Highlights of one surface in the same square form a group. Whether
/// nearer surfaces hide them is tested only once for the group.
constexpr double group_px = 1.5;

}  // namespace

HighlightRule highlight_rule(const Aperture& aperture, const FocusGeometry& geometry) {
    HighlightRule rule;
    rule.above = white;
    if (aperture.varies_over_field() || aperture.spherical_per_m() != 0) return rule;
    const PatchLens lens = patch_lens(geometry);
    rule.takes = [lens](const Highlight& light, const SheetKey& key, const BrightSheet& sheet) {
        if (!light.exceeds(least_radiance)) return false;
        const double blur_px = lens.least_blur_px(light.w);
        const bool is_blurred = blur_px >= sharp_below_px;
        if (sheet.hides == Hides::nothing) return is_blurred || sheet.area_px2 < sharp_px2;
        // A highlight in a mirror may be partly hidden by other objects in the mirror. This is not tested, so
        // a blur kernel may spread light that is hidden. Therefore, a sharp highlight is spread only if it
        // is small.
        if (key.path.bits() != 0) return is_blurred || sheet.area_px2 < small_px2;
        // A nearer surface may hide a part of this highlight. The test of visibility treats the highlight as
        // a point, so it cannot find out which part. If the highlight is larger than its blur, the image
        // would show this error. Therefore, blur kernels spread only highlights that are smaller than their
        // blur.
        return is_blurred && static_cast<double>(sheet.area_px2) < blur_px * blur_px;
    };
    return rule;
}

FieldHighlights::FieldHighlights(const TreeSheets& sheets, const Aperture& aperture,
                                 const FocusGeometry& geometry, const RasterWindow& window,
                                 const HighlightMotion* motion)
    : sheets_(sheets),
      aperture_(aperture),
      geometry_(geometry),
      window_(window),
      round_(aperture.is_round()) {
    if (sheets.primary.highlights.empty() && sheets.deeper.highlights.empty()) return;
    model_ = aperture_model(aperture, geometry, std::hypot(window.width(), window.height()) / 2.0);
    const KernelReach limits{window.width() + 1, window.height() + 1};
    kernels_ = std::make_unique<KernelTable>(std::vector<double>{}, limits, *model_);
    KernelNumberCache cache(*kernels_);
    for (const SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) {
        MergedHighlights merged(geometry);
        std::map<std::uint32_t, int> moments;  // instants needed, per moving sheet
        for (const Highlight& h : mesh->highlights) {
            const SheetKey& key = mesh->sheets[h.sheet].key;
            if (motion == nullptr || !motion->moves(key)) {
                merged.add(h, is_sharp(h));
                continue;
            }
            const auto [known, is_first] = moments.try_emplace(h.sheet, 0);
            if (is_first) known->second = motion->moments_wanted(h, key);
            merged.add_moving(h, known->second <= moments_of_eighths    ? 1.0 / 8
                                 : known->second <= moments_of_quarters ? 1.0 / 4
                                                                        : 1.0 / 2);
        }
        std::size_t moving = 0;
        for (const auto& [place, of] : merged.all()) moving += moments.contains(of.light.sheet) ? 1 : 0;
        int most = HighlightMotion::most_moments;
        while (most > least_moments && static_cast<std::size_t>(most) * moving > most_moving) most /= 2;
        sources_.reserve(sources_.size() + merged.all().size());
        for (const auto& [place, of] : merged.all()) {
            for (SourcePart part : of.parts) {
                part.at -= glm::vec2(of.light.x, of.light.y);
                parts_.push_back(part);
            }
            const auto found = moments.find(of.light.sheet);
            if (found == moments.end()) {
                add_source({of.light, -1, 1}, of, *mesh, cache);
                continue;
            }
            const SheetKey& key = mesh->sheets[of.light.sheet].key;
            const int count = std::min(most, found->second);
            for (const HighlightMotion::Moment& m :
                 motion->moments(of.light, key, count, count < found->second))
                add_source(m, of, *mesh, cache);
        }
    }
    kernels_->build();
    make_sharp_kernels(limits);
    group_sources();
    constexpr int edge = SeenTile::edge;
    tile_columns_ = (window.width() + edge - 1) / edge;
    wide_.resize(static_cast<std::size_t>((window.height() + edge - 1) / edge));
    narrow_.resize(static_cast<std::size_t>(tile_columns_) * wide_.size());
    for (std::uint32_t i = 0; i < sources_.size(); ++i) {
        const Source& s = sources_[i];
        const Kernel& k = kernel_of(s);
        if (k.rows.empty()) continue;
        const int around = s.u >= 0 && s.by_all ? passing_px : 0;
        const Reach reach{{s.x + k.x_begin - around, s.x + k.x_end + around, s.y + k.y_begin - around,
                           s.y + k.y_end() + around},
                          i};
        const RasterWindow in = common(reach.pixels, {0, window.width(), 0, window.height()});
        if (in.width() <= 0 || in.height() <= 0) continue;
        for (int row = in.y_begin / edge; row <= (in.y_end - 1) / edge; ++row) {
            if (in.width() > widest_tiles * edge) {
                wide_[static_cast<std::size_t>(row)].push_back(reach);
                continue;
            }
            for (int column = in.x_begin / edge; column <= (in.x_end - 1) / edge; ++column)
                narrow_[static_cast<std::size_t>(row * tile_columns_ + column)].push_back(reach);
        }
    }
}

/// Returns whether the blur of a highlight is so small that its kernel must be computed from the shape of the
/// light (sharp_kernel).
bool FieldHighlights::is_sharp(const Highlight& h) const {
    const glm::dmat2 map = px_from_lens(h, geometry_);
    // This is the blur radius in px, or for an ellipse the mean of both semi-axes in the squares.
    const double radius_px = std::hypot(glm::length(map[0]), glm::length(map[1])) / std::numbers::sqrt2;
    if (!(radius_px < sharp_below_px)) return false;
    // The kernels of an aperture that is an image are expensive, unless they are so small that discs replace
    // them. So they are made once for many sources.
    constexpr double disc_px = 0.5;
    return model_->is_round() || model_->is_even() || model_->reach_px(map) < disc_px;
}

/// Makes the kernels of the almost sharp sources. Before, Source::kernel is the number of the kernel.
void FieldHighlights::make_sharp_kernels(KernelReach limits) {
    std::vector<const Source*> of(sharp_kernels_.size());
    for (const Source& s : sources_) {
        if (s.is_sharp) of[s.kernel] = &s;
    }
    parallel_for(of.size(), [&](std::size_t i) {
        const Source& s = *of[i];
        sharp_kernels_[i] =
            sharp_kernel(std::span(parts_).subspan(s.first_part, s.parts),
                         s.at + s.shift - glm::dvec2(s.x, s.y), s.px_from_lens, *model_, limits);
    });
}

void FieldHighlights::add_source(const HighlightMotion::Moment& m, const MergedHighlights::Merged& of,
                                 const SheetMesh& mesh, KernelNumberCache& cache) {
    const Highlight& h = m.light;
    Source s;
    s.u = m.u;
    s.first_part = static_cast<std::uint32_t>(parts_.size() - of.parts.size());
    s.parts = static_cast<std::uint32_t>(of.parts.size());
    const glm::dmat2 map = px_from_lens(h, geometry_);
    s.px_from_lens = map;
    s.lens_from_px = glm::inverse(map);
    s.at = glm::dvec2(h.x, h.y) - glm::dvec2(window_.x_begin, window_.y_begin);
    for (std::size_t c = 0; c < 3; ++c) s.rgb[c] = static_cast<float>(m.share) * h.rgb[c];
    const double most = static_cast<double>(std::max({h.rgb[0], h.rgb[1], h.rgb[2]}));
    s.light = static_cast<double>(s.rgb[0]) + static_cast<double>(s.rgb[1]) + static_cast<double>(s.rgb[2]);
    s.area = static_cast<double>(h.area);
    s.exposure = m.share;
    if (h.area > 0) s.square = m.share * most * most / static_cast<double>(h.area);
    s.inverse_z = h.inverse_z;
    s.by_all = patch_lens(geometry_).least_blur_px(h.w) < seen_by_all_px;
    s.key = mesh.sheets[h.sheet].key;
    s.sheet = h.sheet;
    const glm::dvec2 middle = s.at + inclination_shift_px(h, geometry_);
    if (of.is_sharp) {
        const glm::dvec2 whole = glm::floor(middle);
        s.x = static_cast<int>(whole.x);
        s.y = static_cast<int>(whole.y);
        s.shift = middle - s.at;
        s.is_sharp = true;
        s.kernel = static_cast<std::uint32_t>(sharp_kernels_.size());
        sharp_kernels_.emplace_back();
        sources_.push_back(s);
        return;
    }
    KernelKey key = round_ ? KernelKey::ellipse(Ellipse::from_map(map, DepthLevels::smallest_radius_px), true)
                           : KernelKey::map(map, true);
    // A sharp moving highlight may extend over several pixels, but one kernel would put all of its light into
    // one pixel. Therefore, the highlight is divided at the borders of pixels, and each part has its own
    // kernel. `side` is the highlight's width, in px; 0 means that it is not divided.
    const double side = s.by_all && s.u >= 0 ? std::sqrt(s.area) : 0;
    for (const Span& y : divided_at_cells(middle.y, side, 1)) {
        for (const Span& x : divided_at_cells(middle.x, side, 1)) {
            Source part = s;
            const glm::dvec2 at(x.middle, y.middle), whole = glm::floor(at);
            part.at += at - middle;
            part.x = static_cast<int>(whole.x);
            part.y = static_cast<int>(whole.y);
            const auto phase = [](double in_pixel) {
                return static_cast<std::int32_t>(std::lround(in_pixel * KernelKey::phase_steps));
            };
            key.phase_x = phase(at.x - whole.x);
            key.phase_y = phase(at.y - whole.y);
            part.kernel = cache.number_of(key);
            const double share = x.share * y.share;
            for (float& channel : part.rgb) channel *= static_cast<float>(share);
            part.light *= share;
            part.area *= share;
            part.square *= share;
            sources_.push_back(part);
        }
    }
}

// Groups nearby highlights of one surface. For each group, the program computes only once which nearer
// surfaces hide its highlights.
void FieldHighlights::group_sources() {
    std::map<std::tuple<bool, std::uint32_t, int, int, bool>, std::uint32_t> known;
    for (Source& s : sources_) {
        const auto cell = [](double at) { return static_cast<int>(std::floor(at / group_px)); };
        const auto [found, is_new] =
            known.try_emplace({s.key.path.bits() == 0, s.sheet, cell(s.at.x), cell(s.at.y), s.by_all},
                              static_cast<std::uint32_t>(groups_.size()));
        const Kernel& k = kernel_of(s);
        s.group = found->second;
        const double light = s.light;
        if (is_new) {
            groups_.push_back({s,
                               cell(s.at.x),
                               cell(s.at.y),
                               light,
                               {},
                               s.x + k.x_begin,
                               s.x + k.x_end,
                               s.y + k.y_begin,
                               s.y + k.y_end()});
            continue;
        }
        Group& g = groups_[s.group];
        g.light += light;
        g.middle.at += light / g.light * (s.at - g.middle.at);
        g.middle.lens_from_px += light / g.light * (s.lens_from_px - g.middle.lens_from_px);
        g.middle.inverse_z = std::max(g.middle.inverse_z, s.inverse_z);
        g.x_begin = std::min(g.x_begin, s.x + k.x_begin);
        g.x_end = std::max(g.x_end, s.x + k.x_end);
        g.y_begin = std::min(g.y_begin, s.y + k.y_begin);
        g.y_end = std::max(g.y_end, s.y + k.y_end());
    }
    for (const Source& s : sources_) {
        Group& g = groups_[s.group];
        const glm::dvec2 off = s.at - g.middle.at;
        g.spread_px += s.light / g.light * off * off;
    }
    for (Group& g : groups_) g.spread_px = glm::sqrt(g.spread_px);
    // Sorts the light sources by group. Two sources with the same `first_part` come from the same highlight,
    // but differ in the instant `u` or in the pixel (x, y). So no two sources compare as equal, and std::sort
    // gives the same order in every run. std::stable_sort is not needed, and would allocate memory.
    std::sort(sources_.begin(), sources_.end(), [](const Source& a, const Source& b) {
        return std::tuple(a.group, a.first_part, a.u, a.y, a.x) <
               std::tuple(b.group, b.first_part, b.u, b.y, b.x);
    });
}

}  // namespace postlens
