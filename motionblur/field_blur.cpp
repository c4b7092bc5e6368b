#include "motionblur/field_blur.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "core/error.h"

namespace postlens {
namespace {

/// As many places in the pixel; what stands still is drawn once for each.
constexpr std::size_t most_places = 64;
constexpr int fewest_views = 128;
constexpr int most_views_by_itself = 512;

/// Place j of a (0, 2)-sequence in base 2 [sobol1967]: every aligned run of 2^k of them has one place in
/// every cell of every grid of 2^k equal cells, so that views close in time lie far apart in the pixel.
glm::dvec2 place(std::uint32_t j, double places) {
    std::uint32_t x = 0, y = 0;
    for (std::uint32_t bit = 0x80000000U, direction = 0x80000000U, i = j; i != 0;
         i >>= 1U, bit >>= 1U, direction ^= direction >> 1U) {
        if ((i & 1U) != 0) {
            x ^= bit;
            y ^= direction;
        }
    }
    constexpr double scale = 1.0 / 4294967296.0;
    return {x * scale + 0.5 / places, y * scale + 0.5 / places};
}

int views_for(const std::vector<IdMotion>& ids, const FieldBlurSettings& settings) {
    if (settings.views) return *settings.views;
    double longest = 0;
    for (const IdMotion& m : ids) {
        if (m.kind != MotionKind::still && std::isfinite(m.largest_move_px))
            longest = std::max(longest, m.largest_move_px);
    }
    // A view for every two pixels of the longest way: against 2048 views, 128 err by 51 dB on a box that goes
    // 128 px, 256 by 59 dB on a wheel of 467 px that rolls (docs/motion.md).
    const double wanted = std::clamp(longest / 2, 1.0, static_cast<double>(most_views_by_itself));
    return std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(wanted)))), fewest_views,
                      most_views_by_itself);
}

}  // namespace

FieldBlur field_blur(const SampleHeader& header, const std::vector<SampleMesh>& meshes,
                     const FrameMotion& motion, const std::vector<IdMotion>& ids,
                     const std::vector<std::uint32_t>& wanted_ids, const FieldBlurSettings& settings) {
    if (settings.views && (*settings.views < 1 || *settings.views > FieldBlurSettings::most_views)) {
        fail(ExitCode::wrong_arguments, "--views: out of range (got {}; expected 1 to {})", *settings.views,
             FieldBlurSettings::most_views);
    }
    FieldBlur out;
    out.views = settings.exposure.close_s > settings.exposure.open_s || settings.views
                    ? views_for(ids, settings)
                    : fewest_views;
    out.mesh_shares.assign(meshes.size(), 0);
    LightField field;
    field.width = header.width;
    field.height = header.height;
    for (const SampleMesh& m : meshes) field.meshes.push_back(&m);

    constexpr std::uint8_t wanted_mark = 2, other_mark = 1;
    std::unordered_map<std::uint32_t, std::size_t> classes;
    std::vector<std::uint32_t> moving;
    field.class_marks.push_back(0);
    for (const IdMotion& m : ids) {
        if (m.kind == MotionKind::still) continue;
        classes.emplace(m.id, moving.size() + 1);
        moving.push_back(m.id);
        const bool wanted =
            wanted_ids.empty() || std::binary_search(wanted_ids.begin(), wanted_ids.end(), m.id);
        field.class_marks.push_back(wanted ? wanted_mark : other_mark);
    }
    field.wanted_marks = wanted_mark;
    field.motion_classes = moving.size() + 1;
    field.motion_class = [&classes](std::uint32_t id) {
        const auto found = classes.find(id);
        return found == classes.end() ? std::size_t{0} : found->second;
    };

    std::vector<std::size_t> by_time(meshes.size());
    std::iota(by_time.begin(), by_time.end(), std::size_t{0});
    std::sort(by_time.begin(), by_time.end(),
              [&](std::size_t a, std::size_t b) { return meshes[a].time_s < meshes[b].time_s; });
    const auto use_of = [&](std::size_t mesh, double share, double time_s) {
        FieldView::Use use{mesh, share, {RasterMap()}};
        for (const std::uint32_t id : moving) use.maps.push_back(motion.map(id, meshes[mesh].time_s, time_s));
        return use;
    };
    const auto places = std::min<std::size_t>(most_places, static_cast<std::size_t>(out.views));
    for (int i = 0; i < out.views; ++i) {
        FieldView v;
        v.sample = place(static_cast<std::uint32_t>(i) % static_cast<std::uint32_t>(places),
                         static_cast<double>(places));
        const double share = settings.curve.time((i + 0.5) / out.views);
        const double t =
            settings.exposure.open_s + share * (settings.exposure.close_s - settings.exposure.open_s);
        const auto after =
            std::upper_bound(by_time.begin(), by_time.end(), t,
                             [&](double time, std::size_t m) { return time < meshes[m].time_s; });
        if (after == by_time.begin()) {
            v.uses.push_back(use_of(by_time.front(), 1, t));
        } else if (after == by_time.end()) {
            v.uses.push_back(use_of(by_time.back(), 1, t));
        } else {
            const std::size_t a = *(after - 1), b = *after;
            const double share_b = (t - meshes[a].time_s) / (meshes[b].time_s - meshes[a].time_s);
            v.uses.push_back(use_of(a, 1 - share_b, t));
            v.uses.push_back(use_of(b, share_b, t));
        }
        for (const FieldView::Use& use : v.uses) out.mesh_shares[use.mesh] += use.share / out.views;
        field.views.push_back(std::move(v));
    }
    out.picture = light_field(field);
    return out;
}

}  // namespace postlens
