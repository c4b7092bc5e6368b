#include "motionblur/field_blur.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "motionblur/shutter_views.h"
#include "reproject/instants_around.h"

namespace postlens {
namespace {

int views_for(const std::vector<IdMotion>& ids, const FieldBlurSettings& settings) {
    if (settings.views) return *settings.views;
    double longest = 0;
    for (const IdMotion& m : ids) {
        if (m.kind != MotionKind::still && std::isfinite(m.largest_move_px))
            longest = std::max(longest, m.largest_move_px);
    }
    return views_for_way(longest);
}

}  // namespace

FieldBlur field_blur(const SampleHeader& header, const std::vector<SampleMesh>& meshes,
                     const FrameMotion& motion, const std::vector<IdMotion>& ids,
                     const std::vector<std::uint32_t>& wanted_ids, const FieldBlurSettings& settings) {
    check_views(settings.views);
    FieldBlur out;
    out.views = settings.exposure.close_s > settings.exposure.open_s || settings.views
                    ? views_for(ids, settings)
                    : fewest_views;
    out.mesh_shares.assign(meshes.size(), 0);
    LightField field;
    field.width = header.width;
    field.height = header.height;
    field.crop = settings.crop;
    for (const SampleMesh& m : meshes) field.meshes.push_back(&m);

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
    field.motion_classes = moving.size() + 1;
    field.motion_class = [&classes](std::uint32_t id) {
        const auto found = classes.find(id);
        return found == classes.end() ? std::size_t{0} : found->second;
    };

    std::vector<double> instants_s;
    for (const SampleMesh& m : meshes) instants_s.push_back(m.time_s);
    const auto use_of = [&](std::size_t mesh, double share, double time_s) {
        FieldView::Use use{mesh, share, {RasterMap()}};
        for (const std::uint32_t id : moving) use.maps.push_back(motion.map(id, meshes[mesh].time_s, time_s));
        return use;
    };
    for (const auto& [place, t] : shutter_views(settings.curve, settings.exposure, out.views)) {
        FieldView v;
        v.sample = place;
        for (const InstantShare& m : instants_around(instants_s, t))
            v.uses.push_back(use_of(m.instant, m.share, t));
        for (const FieldView::Use& use : v.uses) out.mesh_shares[use.mesh] += use.share / out.views;
        field.views.push_back(std::move(v));
    }
    out.picture = light_field(field);
    return out;
}

}  // namespace postlens
