#include "reproject/patches/border_reach.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

constexpr double farthest_px = 1e9;  ///< farther than any displacement that matters

}  // namespace

BorderReach::BorderReach(const PatchMesh& primary, const PatchField& field, std::size_t instant) {
    const SheetMesh& mesh = *primary.sheets;
    const int x0 = field.recorded_begin.x, y0 = field.recorded_begin.y, x1 = field.recorded_end.x,
              y1 = field.recorded_end.y;
    const auto length = [](int begin, int end) {
        return std::vector<Cell>(static_cast<std::size_t>(end - begin));
    };
    sides_ = {Side{true, false, y0, static_cast<double>(x0), length(y0, y1)},
              Side{true, true, y0, static_cast<double>(x1), length(y0, y1)},
              Side{false, false, x0, static_cast<double>(y0), length(x0, x1)},
              Side{false, true, x0, static_cast<double>(y1), length(x0, x1)}};
    for (const Sheet& s : mesh.sheets) {
        if (s.key.hidden) continue;
        for (Side& side : sides_) {
            const int low = side.across ? s.x : s.y, high = side.across ? s.x + s.width : s.y + s.height;
            if ((side.after ? high : low) != static_cast<int>(side.at)) continue;
            const int along = side.across ? s.height : s.width;
            for (int i = 0; i < along; ++i) {
                const int x = side.across ? (side.after ? s.width - 1 : 0) : i,
                          y = side.across ? i : (side.after ? s.height - 1 : 0);
                const std::size_t k = s.first_cell + static_cast<std::size_t>(y * s.width + x);
                if (mesh.fine[k] == SheetNode::none) continue;
                Cell& cell = side.cells[static_cast<std::size_t>((side.across ? s.y : s.x) + i - side.first)];
                const float z = mesh.planes[k * mesh.values].value;
                if (cell.any && z <= cell.inverse_z) continue;
                cell = {z, field.motion_class ? field.motion_class(s.key.id) : 0, true};
            }
        }
    }
    LensReach lens;
    for (const PatchViews& set : field.sets) {
        for (const PatchView& view : set.views) lens.add(view.lens);
    }
    const std::vector<TimeSpanViews> spans = time_spans(field, instant);
    for (Side& side : sides_) {
        for (std::size_t i = 0; i < side.cells.size(); ++i) {
            if (side.cells[i].any) side.widen({0, 0}, lens.px(static_cast<double>(side.cells[i].inverse_z)));
        }
        for (const TimeSpanViews& span : spans) side.widen(span, lens);
    }
}

void BorderReach::LensReach::add(const LensShift& view) {
    lens_px = glm::max(lens_px, glm::abs(view.lens_px));
    offset_px = glm::max(offset_px, glm::abs(view.offset_px));
    nearest_focus_per_m = std::max(nearest_focus_per_m, view.inverse_focus_per_m);
    farthest_focus_per_m = std::min(farthest_focus_per_m, view.inverse_focus_per_m);
}

glm::dvec2 BorderReach::LensReach::px(double inverse_z) const {
    return std::max(std::abs(nearest_focus_per_m - inverse_z), std::abs(farthest_focus_per_m - inverse_z)) *
               lens_px +
           offset_px;
}

void BorderReach::Side::widen(const glm::dvec2& moved_px, const glm::dvec2& around_px) {
    const double into = (after ? -1 : 1) * (across ? moved_px.x : moved_px.y),
                 along = std::abs(across ? moved_px.y : moved_px.x);
    deepest_px = std::max(deepest_px, into + (across ? around_px.x : around_px.y));
    sideways_px = std::max(sideways_px, along + (across ? around_px.y : around_px.x));
}

void BorderReach::Side::widen(const TimeSpanViews& span, const LensReach& lens) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Cell& cell = cells[i];
        if (!cell.any || span.first.use->motions[cell.motion_class].identity()) continue;
        const double middle = first + static_cast<double>(i) + 0.5;
        const RasterPoint from{across ? at : middle, across ? middle : at,
                               static_cast<double>(cell.inverse_z)};
        const auto begin = span.first.use->motions[cell.motion_class](from),
                   end = span.last.use->motions[cell.motion_class](from);
        if (!begin && !end) continue;
        if (!begin || !end) {  // the cell moves through the plane of the camera, so it may be anywhere
            deepest_px = sideways_px = farthest_px;
            continue;
        }
        const glm::dvec2 between(glm::distance(glm::dvec2(begin->x, begin->y), glm::dvec2(end->x, end->y)));
        for (const RasterPoint& p : {*begin, *end})
            widen({p.x - from.x, p.y - from.y}, between + lens.px(p.inverse_z));
    }
}

BorderReach::Seen BorderReach::see(const Side& side, std::size_t i, const PatchView& view,
                                   const PatchView::Use& use) {
    const Cell& cell = side.cells[i];
    if (!cell.any) return {};
    const double along = side.first + static_cast<double>(i) + 0.5;
    RasterPoint p{side.across ? side.at : along, side.across ? along : side.at,
                  static_cast<double>(cell.inverse_z)};
    if (!use.motions.empty() && !use.motions[cell.motion_class].identity()) {
        const auto moved = use.motions[cell.motion_class](p);
        if (!moved) return {};
        p = *moved;
    }
    const glm::dvec2 to = glm::dvec2(p.x, p.y) +
                          (view.lens.inverse_focus_per_m - p.inverse_z) * view.lens.lens_px +
                          view.lens.offset_px;
    return {side.across ? to.y : to.x, side.across ? to.x : to.y, p.inverse_z, true};
}

bool BorderReach::Side::reaches(const TilePlace& tile) const {
    const double low = across ? tile.x : tile.y, high = low + (across ? tile.width : tile.height);
    return !cells.empty() && (after ? high >= at - deepest_px : low <= at + deepest_px);
}

bool BorderReach::reaches(const TilePlace& at) const {
    return std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) { return side.reaches(at); });
}

void BorderReach::mark(const PatchView& view, const PatchView::Use& use, const TilePlace& at,
                       SeenTile& seen) const {
    for (const Side& side : sides_) {
        const double low = side.across ? at.x : at.y, high = low + (side.across ? at.width : at.height),
                     begin = side.across ? at.y : at.x, end = begin + (side.across ? at.height : at.width);
        if (!side.reaches(at)) continue;
        const double reach = std::min(side.sideways_px, farthest_px) + 2;
        const auto cells = static_cast<std::ptrdiff_t>(side.cells.size());
        const auto first = static_cast<std::ptrdiff_t>(std::floor(begin - reach - side.first)),
                   last = static_cast<std::ptrdiff_t>(std::ceil(end + reach - side.first));
        const double sample_along = side.across ? at.sample.y : at.sample.x,
                     sample_across = side.across ? at.sample.x : at.sample.y;
        const auto mark_cell = [&](const Seen& s, double along) {
            if (along < begin - 2 || along > end + 2) return;
            // Marks the pixels of the view that a surface may cover beyond the border of the recorded image.
            // `along` is the position, in the direction of the border, at which the view shows a border
            // pixel. Pixels up to 1 px beside it are marked too, because the surface may continue obliquely.
            const int a0 = std::max(0, static_cast<int>(std::ceil(along - 1 - begin - sample_along))),
                      a1 = std::min(static_cast<int>(end - begin) - 1,
                                    static_cast<int>(std::floor(along + 1 - begin - sample_along)));
            const double edge = s.across - low - sample_across;
            const int b0 = side.after ? std::max(0, static_cast<int>(std::ceil(std::clamp(edge, -1.0, 1e6))))
                                      : 0,
                      b1 = side.after ? static_cast<int>(high - low) - 1
                                      : std::min(static_cast<int>(high - low) - 1,
                                                 static_cast<int>(std::floor(std::clamp(edge, -1.0, 1e6))));
            for (int a = a0; a <= a1; ++a) {
                for (int b = b0; b <= b1; ++b) {
                    const int x = side.across ? b : a, y = side.across ? a : b;
                    float& maybe = seen.maybe_inverse_z[static_cast<std::size_t>(y) * SeenTile::edge +
                                                        static_cast<std::size_t>(x)];
                    maybe = std::max(maybe, static_cast<float>(s.inverse_z));
                }
            }
        };
        for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(first, 0); i <= std::min(last, cells - 1); ++i) {
            const Seen s = see(side, static_cast<std::size_t>(i), view, use);
            if (s.any) mark_cell(s, s.along);
        }
        const auto mark_beyond = [&](std::ptrdiff_t corner, std::ptrdiff_t from, std::ptrdiff_t to) {
            const Seen s = see(side, static_cast<std::size_t>(corner), view, use);
            if (!s.any || !(std::abs(s.along) < farthest_px)) return;
            const double before = s.along - static_cast<double>(corner);
            from = std::max(from, static_cast<std::ptrdiff_t>(std::floor(begin - 2 - before)));
            to = std::min(to, static_cast<std::ptrdiff_t>(std::ceil(end + 2 - before)));
            for (std::ptrdiff_t i = from; i <= to; ++i) mark_cell(s, before + static_cast<double>(i));
        };
        mark_beyond(0, first, std::min<std::ptrdiff_t>(last, -1));
        mark_beyond(cells - 1, std::max(first, cells), last);
    }
}

}  // namespace postlens
