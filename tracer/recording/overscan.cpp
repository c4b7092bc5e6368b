#include "tracer/recording/overscan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/threads.h"

namespace postlens {
namespace {

constexpr int step_px = 8;
constexpr int largest_px = 4096;

// Returns the radius, px, of the largest circle of confusion of the surfaces that the pinhole sees through
// one raster point, directly or after reflection and refraction.
double widest_radius_px(const FocusGeometry& lens, std::span<const Record> records) {
    double widest = 0;
    for (const Record& r : records) {
        if (r.layer != 0) continue;
        const double f = lens.inverse_focus_per_m;
        const auto a = static_cast<double>(r.w.xx), b = static_cast<double>(r.w.xy),
                   c = static_cast<double>(r.w.yx), d = static_cast<double>(r.w.yy);
        widest = std::max(widest,
                          std::sqrt((f - a) * (f - a) + b * b + c * c + (f - d) * (f - d)) / std::sqrt(2.0));
    }
    return widest * lens.aperture_radius_m * lens.gain_px;
}

double outside_px(const CameraModel& camera, const glm::dvec2& p) {
    return std::max({-p.x, p.x - camera.width, -p.y, p.y - camera.height});
}

// Returns true if motion brings a surface into the frame. The camera sees the surface at the raster position
// `at`, outside the frame, and `records` describes it. Because the eye rays of this search are `step_px`
// apart, a part of the surface may lie closer to the frame. So it suffices if the surface comes within
// `step_px` of the frame.
bool comes_to_frame(const FilmMotion& motion, const CameraModel& camera, const glm::dvec2& at,
                    std::span<const Record> records) {
    constexpr double stays_px = 0.25;  // a smaller displacement is not visible
    const CameraRay eye = camera.ray(at.x, at.y);
    const double outside = outside_px(camera, at);
    for (const Record& r : records) {
        if (r.path.bits() != 0) continue;
        for (std::size_t i = 0; i < motion.instants(); ++i) {
            const auto p =
                r.id == 0
                    ? motion.place_of_nothing(eye.direction, at, i)
                    : motion.place(r.id, eye.origin + static_cast<double>(r.z) / eye.cos_axis * eye.direction,
                                   i);
            if (!p) continue;
            const double then = outside_px(camera, *p);
            if (then < step_px && then < outside - stays_px) return true;
        }
    }
    return false;
}

}  // namespace

int find_overscan(const WhittedTracer& tracer, const CameraModel& camera,
                  const std::optional<FocusGeometry>& lens, const FilmMotion* motion) {
    const int farthest = std::min(largest_px, std::max(camera.width, camera.height) / 2);
    // Returns the positions, px, of eye rays along one axis of the raster. They lie `step_px` apart, from the
    // overscan (the pixels traced beside the frame) on one side to that on the other side. The frame's border
    // is always one of them, so that a surface is found even if it extends only slightly beyond the frame.
    const auto positions = [farthest](int size) {
        std::vector<int> out;
        for (int p = -(farthest / step_px) * step_px; p < size; p += step_px) out.push_back(p);
        for (int p = size; p <= size + farthest; p += step_px) out.push_back(p);
        return out;
    };
    std::vector<std::vector<glm::dvec2>> rows;
    for (const int y : positions(camera.height)) {
        std::vector<glm::dvec2> row;
        for (const int x : positions(camera.width)) {
            if (x <= 0 || y <= 0 || x >= camera.width || y >= camera.height) row.emplace_back(x, y);
        }
        rows.push_back(std::move(row));
    }
    std::vector<int> needed(rows.size(), 0);
    parallel_for(rows.size(), [&](std::size_t i) {
        TracedSamples traced;
        RayCounts counts;
        tracer.trace(rows[i], traced, counts);
        for (std::size_t k = 0; k < rows[i].size(); ++k) {
            const glm::dvec2 p = rows[i][k];
            const auto records = std::span(traced.records)
                                     .subspan(traced.offsets[k], traced.offsets[k + 1] - traced.offsets[k]);
            const double outside = outside_px(camera, p);
            const bool wanted = (lens && widest_radius_px(*lens, records) + step_px > outside) ||
                                (motion != nullptr && comes_to_frame(*motion, camera, p, records));
            if (wanted) needed[i] = std::max(needed[i], static_cast<int>(std::ceil(outside)) + step_px);
        }
    });
    return rows.empty() ? 0 : std::min(farthest, *std::max_element(needed.begin(), needed.end()));
}

}  // namespace postlens
