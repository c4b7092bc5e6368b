#include "motionblur/field_blur.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "motionblur/shutter_views.h"
#include "reproject/instants_around.h"
#include "reproject/patches/motion_strain.h"

namespace postlens {
namespace {

int views_for(const std::vector<IdMotion>& ids, const FieldBlurSettings& settings) {
    if (settings.views) return *settings.views;
    double longest = 0;
    for (const IdMotion& m : ids) {
        if (m.kind != MotionKind::still && std::isfinite(m.path_px)) longest = std::max(longest, m.path_px);
    }
    return views_for_way(longest);
}

}  // namespace

std::vector<SheetMesh> blur_sheets(const SampleFileReader& file) {
    HighlightRule rule;
    rule.above = HUGE_VALF;
    SheetChoice choice;
    choice.deeper = false;
    std::vector<SheetMesh> out;
    for (std::size_t i = 0; i < file.instants(); ++i)
        out.push_back(tree_sheets(file, i, rule, {}, choice).primary);
    return out;
}

FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                     const FrameMotion& motion, const std::vector<IdMotion>& ids,
                     const std::vector<std::uint32_t>& wanted_ids, const FieldBlurSettings& settings) {
    check_views(settings.views);
    FieldBlur out;
    out.views = settings.exposure.close_s > settings.exposure.open_s || settings.views
                    ? views_for(ids, settings)
                    : most_places;
    out.instant_shares.assign(sheets.size(), 0);
    PatchField field;
    field.width = header.width;
    field.height = header.height;
    field.recorded_begin = glm::ivec2(-header.overscan_px);
    field.recorded_end = glm::ivec2(header.width, header.height) + header.overscan_px;

    constexpr std::uint8_t other_mark = 1;
    std::unordered_map<std::uint32_t, std::size_t> classes;
    std::vector<std::uint32_t> moving;
    field.class_marks.push_back(0);
    for (const IdMotion& m : ids) {
        if (m.kind == MotionKind::still) continue;
        classes.emplace(m.id, moving.size() + 1);
        moving.push_back(m.id);
        const bool wanted = std::binary_search(wanted_ids.begin(), wanted_ids.end(), m.id);
        field.class_marks.push_back(wanted ? wanted_mark : other_mark);
    }
    field.wanted_marks = wanted_mark;
    field.motion_class = [&classes](std::uint32_t id) {
        const auto found = classes.find(id);
        return found == classes.end() ? std::size_t{0} : found->second;
    };

    std::vector<double> instants_s;
    instants_s.reserve(sheets.size());
    for (const SheetMesh& m : sheets) instants_s.push_back(m.time_s);
    PatchViews set;
    for (const auto& [place, t] : shutter_views(settings.curve, settings.exposure, out.views)) {
        PatchView v;
        v.sample = place;
        for (const InstantShare& at : instants_around(instants_s, t)) {
            PatchView::Use use{at.instant, at.share, {RasterMap()}};
            for (const std::uint32_t id : moving)
                use.motions.push_back(motion.map(id, instants_s[at.instant], t));
            out.instant_shares[at.instant] += at.share / out.views;
            v.uses.push_back(std::move(use));
        }
        set.views.push_back(std::move(v));
    }
    PatchLens lens;  // a pinhole
    lens.follow_px = PatchLens::all_follow;
    StrainOfMotions strain{{}, field.motion_class};
    const std::size_t step = std::max<std::size_t>(1, set.views.size() / strain_views);
    for (std::size_t i = 0; i < set.views.size(); i += step) {
        for (const auto& use : set.views[i].uses) strain.views.push_back(use.motions);
    }
    lens.motion = std::move(strain);
    std::vector<PatchMesh> patches;
    patches.reserve(sheets.size());
    for (const SheetMesh& m : sheets) patches.push_back(cut_patches(m, lens));
    for (const PatchMesh& m : patches) field.instants.push_back({&m, nullptr});
    field.sets.push_back(std::move(set));
    out.picture = touched_picture(field, settings.crop);
    return out;
}

PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop) {
    field.sets.front().wanted = [&](int x, int y, int w, int h) { return !crop || crop->meets(x, y, w, h); };
    PatchPicture out(field.width, field.height);
    patch_field(field, std::span(&out, 1));
    for (std::size_t k = 0; k < out.touched.size(); ++k) {
        if (out.touched[k] == 0) out.unknown[k] = 0;
    }
    return out;
}

void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind) {
    for (std::size_t k = 0; k < seen.touched.size(); ++k) {
        if ((seen.touched[k] & marks) == 0) continue;
        const float gap = seen.unknown[k];
        for (std::size_t c = 0; c < 3; ++c) {
            float& to = image.rgb[3 * k + c];
            to = seen.image.rgb[3 * k + c];
            if (gap > 0) to = (1 - gap) * to + gap * behind.rgb[3 * k + c];
        }
    }
}

}  // namespace postlens
