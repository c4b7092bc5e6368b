#include "reproject/patches/patch_sweep.h"

#include <algorithm>
#include <cmath>

namespace postlens {

std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch) {
    const SheetKey& key = mesh.sheet(patch).key;
    return field.motion_class(key.path.bits() == 0 ? key.id : key.parent_id);
}

PatchSweep::PatchSweep(const PatchField& field) : field_(field) {
    for (const PatchViews& set : field.sets) {
        for (const PatchView& v : set.views) note(v);
    }
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
        Box& box = boxes_[i];
        if (std::find(box.moves.begin(), box.moves.end(), 1) != box.moves.end())
            box.spans = time_spans(field, i);
        box.low.lens_px = glm::min(box.low.lens_px, -field.lens_reach_px);
        box.high.lens_px = glm::max(box.high.lens_px, field.lens_reach_px);
    }
}

void PatchSweep::note(const PatchView& v) {
    for (const auto& use : v.uses) {
        if (boxes_.size() <= use.instant) boxes_.resize(use.instant + 1);
        Box& box = boxes_[use.instant];
        if (box.moves.size() < use.motions.size()) box.moves.resize(use.motions.size(), 0);
        for (std::size_t c = 0; c < use.motions.size(); ++c) {
            if (!use.motions[c].identity()) box.moves[c] = 1;
        }
        if (!box.any) box.low = box.high = v.lens;
        box.any = true;
        box.low.lens_px = glm::min(box.low.lens_px, v.lens.lens_px);
        box.high.lens_px = glm::max(box.high.lens_px, v.lens.lens_px);
        box.low.offset_px = glm::min(box.low.offset_px, v.lens.offset_px);
        box.high.offset_px = glm::max(box.high.offset_px, v.lens.offset_px);
    }
}

template <typename Add>
void PatchSweep::for_corners(const Box& box, const Add& add) {
    for (int k = 0; k < 16; ++k) {
        LensShift corner = box.low;
        if ((k & 1) != 0) corner.lens_px.x = box.high.lens_px.x;
        if ((k & 2) != 0) corner.lens_px.y = box.high.lens_px.y;
        if ((k & 4) != 0) corner.offset_px.x = box.high.offset_px.x;
        if ((k & 8) != 0) corner.offset_px.y = box.high.offset_px.y;
        if (k >= 4 && box.low.offset_px == box.high.offset_px) break;
        add(corner);
    }
}

void PatchSweep::add_span(const PatchMesh& mesh, const Patch& patch, std::size_t motion, const Box& box,
                          const TimeSpanViews& span, RasterRect& out) {
    const bool single = span.first.view == span.last.view;
    const auto lies = [&](const TimeSpanViews::ViewUse& at) {
        RasterRect rect;
        PatchPlace place;
        const auto add = [&](const LensShift& lens) {
            if (place_patch(mesh, patch, at.use->motions[motion], lens, place))
                rect.add(covered(patch, place));
        };
        if (single)
            add(at.view->lens);
        else
            for_corners(box, add);
        return rect;
    };
    const RasterRect first = lies(span.first), last = single ? first : lies(span.last);
    const auto any = [](const RasterRect& r) { return r.x_min <= r.x_max; };
    if (!any(first) && !any(last)) return;
    if (any(first) != any(last)) {  // the patch moves through the plane of the camera, so it may be anywhere
        constexpr double far = 1e9;
        out.add({-far, far, -far, far});
        return;
    }
    const double x = std::max(std::abs(first.x_min - last.x_min), std::abs(first.x_max - last.x_max)),
                 y = std::max(std::abs(first.y_min - last.y_min), std::abs(first.y_max - last.y_max));
    // `first` and `last` are the bounding rectangles of the patch's image at the beginning and the end of a
    // span of time. Between these instants, the image may move on a curve. The curve is assumed to deviate
    // from the straight line by at most `away`, the distance that the corners move.
    const double away = glm::length(glm::dvec2(x, y));
    out.add({std::min(first.x_min, last.x_min) - away, std::max(first.x_max, last.x_max) + away,
             std::min(first.y_min, last.y_min) - away, std::max(first.y_max, last.y_max) + away});
}

RasterRect PatchSweep::of(const PatchMesh& mesh, const Patch& patch, std::size_t instant) const {
    RasterRect out;
    if (instant >= boxes_.size() || !boxes_[instant].any) return out;
    const Box& box = boxes_[instant];
    const std::size_t motion = box.moves.empty() ? 0 : motion_class_of(field_, mesh, patch);
    if (motion < box.moves.size() && box.moves[motion] != 0) {
        for (const TimeSpanViews& span : box.spans) add_span(mesh, patch, motion, box, span, out);
        return out;
    }
    PatchPlace place;
    for_corners(box, [&](const LensShift& lens) {
        if (place_patch(mesh, patch, {}, lens, place)) out.add(covered(patch, place));
    });
    return out;
}

}  // namespace postlens
