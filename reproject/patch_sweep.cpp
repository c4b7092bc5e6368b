#include "reproject/patch_sweep.h"

namespace postlens {

std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch) {
    const SheetKey& key = mesh.sheet(patch).key;
    return field.motion_class(key.path.bits() == 0 ? key.id : key.parent_id);
}

PatchSweep::PatchSweep(const PatchField& field) : field_(field) {
    for (const PatchViews& set : field.sets) {
        for (const PatchView& v : set.views) note(v);
    }
    for (Box& box : boxes_) {
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

RasterRect PatchSweep::of(const PatchMesh& mesh, const Patch& patch, std::size_t instant) const {
    RasterRect out;
    if (instant >= boxes_.size()) return out;
    PatchPlace place;
    const auto add = [&](const RasterMap& motion, const LensShift& lens) {
        if (place_patch(mesh, patch, motion, lens, place)) out.add(covered(patch, place));
    };
    const Box& box = boxes_[instant];
    const std::size_t motion = box.moves.empty() ? 0 : motion_class_of(field_, mesh, patch);
    if (motion < box.moves.size() && box.moves[motion] != 0) {
        for (const PatchViews& set : field_.sets) {
            for (const PatchView& v : set.views) {
                for (const auto& use : v.uses) {
                    if (use.instant != instant) continue;
                    add(use.motions.empty() ? RasterMap() : use.motions[motion], v.lens);
                }
            }
        }
        return out;
    }
    if (!box.any) return out;
    for (int k = 0; k < 16; ++k) {
        LensShift corner = box.low;
        if ((k & 1) != 0) corner.lens_px.x = box.high.lens_px.x;
        if ((k & 2) != 0) corner.lens_px.y = box.high.lens_px.y;
        if ((k & 4) != 0) corner.offset_px.x = box.high.offset_px.x;
        if ((k & 8) != 0) corner.offset_px.y = box.high.offset_px.y;
        if (k >= 4 && box.low.offset_px == box.high.offset_px) break;
        add({}, corner);
    }
    return out;
}

}  // namespace postlens
