#include "reproject/raster_map.h"

#include <algorithm>
#include <cmath>

namespace postlens {

using glm::dmat4;
using glm::dvec4;

namespace {

std::vector<double> times_of(const std::vector<TransformKey>& keys) {
    std::vector<double> out;
    out.reserve(keys.size());
    for (const TransformKey& k : keys) out.push_back(k.time_s);
    return out;
}

}  // namespace

RasterMap through_lens(const RasterMap& motion, const LensShift& lens) {
    if (lens.none()) return motion;
    // The columns multiply x, y, 1 and 1/z'.
    dmat4 shift(1);
    const glm::dvec2 still = lens.inverse_focus_per_m * lens.lens_px + lens.offset_px;
    shift[2][0] = still.x;
    shift[2][1] = still.y;
    shift[3][0] = -lens.lens_px.x;
    shift[3][1] = -lens.lens_px.y;
    return {shift * motion.matrix(), Projection::perspective};
}

dmat4 camera_from_raster(const SampleHeader& h) {
    const bool perspective = h.projection == Projection::perspective;
    const double scale =
        perspective ? h.pixel_pitch_mm / h.film_distance_mm : h.pixel_pitch_mm * 1e-3;  // tangent or m per px
    const double x0 = -0.5 * h.width * scale, y0 = 0.5 * h.height * scale;
    // The matrix maps a surface point with the raster position (x, y), in px, and the depth z, in m, to
    // homogeneous camera coordinates. For a perspective camera, it maps (x, y, 1, 1/z) to (X / z, Y / z, -1,
    // 1 / z), where (X, Y, -z) is the point in the camera's frame. For an orthographic camera, it maps (x, y,
    // z, 1) to (X, Y, -z, 1).
    return perspective
               ? dmat4(dvec4(scale, 0, 0, 0), dvec4(0, -scale, 0, 0), dvec4(x0, y0, -1, 0), dvec4(0, 0, 0, 1))
               : dmat4(dvec4(scale, 0, 0, 0), dvec4(0, -scale, 0, 0), dvec4(0, 0, -1, 0),
                       dvec4(x0, y0, 0, 1));
}

std::optional<RasterPoint> RasterMap::operator()(const RasterPoint& p) const {
    if (projection_ == Projection::perspective) {
        const dvec4 q = m_ * dvec4(p.x, p.y, 1, p.inverse_z);
        if (!(q.z > 0)) return std::nullopt;
        return RasterPoint{q.x / q.z, q.y / q.z, p.inverse_z / q.z};
    }
    if (p.inverse_z == 0) return p;
    const dvec4 q = m_ * dvec4(p.x, p.y, 1 / p.inverse_z, 1);
    if (!(q.z > 0)) return std::nullopt;
    return RasterPoint{q.x, q.y, 1 / q.z};
}

std::optional<RasterTangent> RasterMap::tangent(const RasterPoint& p, const glm::dvec2& slope,
                                                const glm::dvec2& reach) const {
    const bool perspective = projection_ == Projection::perspective;
    if (!perspective && p.inverse_z == 0) return RasterTangent{p, {1, 0, slope.x}, {0, 1, slope.y}};
    // `slope` is the gradient of the inverse depth 1/z over the raster. For an orthographic camera, the
    // matrix `m` maps z instead of 1/z, so the gradient of z is needed. It is -z^2 times the gradient of 1/z.
    const double z = perspective ? 1 : 1 / p.inverse_z, by_depth = perspective ? 1 : -z * z;
    const glm::dmat4& m = m_;
    const dvec4 depth = perspective ? m[3] : m[2];
    const dvec4 q = m * (perspective ? dvec4(p.x, p.y, 1, p.inverse_z) : dvec4(p.x, p.y, z, 1)),
                q_x = m[0] + by_depth * slope.x * depth, q_y = m[1] + by_depth * slope.y * depth;
    const double change = std::abs(q_x.z) * reach.x + std::abs(q_y.z) * reach.y;
    if (!(q.z > change)) return std::nullopt;
    const double w = 1 / q.z;
    if (!perspective) {
        const auto by = [&](const dvec4& d) { return RasterPoint{d.x, d.y, -d.z * w * w}; };
        return RasterTangent{{q.x, q.y, w}, by(q_x), by(q_y), by_depth * glm::dvec2(depth), 0};
    }
    const RasterPoint at{q.x * w, q.y * w, p.inverse_z * w};
    const auto by = [&](const dvec4& d, double step) {
        return RasterPoint{(d.x - at.x * d.z) * w, (d.y - at.y * d.z) * w, (step - at.inverse_z * d.z) * w};
    };
    RasterTangent out{at, by(q_x, slope.x), by(q_y, slope.y)};
    out.by_depth = {(depth.x - at.x * depth.z) * w, (depth.y - at.y * depth.z) * w};
    out.bend_px = change * w *
                  (glm::length(glm::dvec2(out.by_x.x, out.by_x.y)) * reach.x +
                   glm::length(glm::dvec2(out.by_y.x, out.by_y.y)) * reach.y);
    return out;
}

FrameMotion::FrameMotion(const SampleHeader& header)
    : projection_(header.projection),
      camera_from_raster_(camera_from_raster(header)),
      raster_from_camera_(glm::inverse(camera_from_raster_)),
      world_from_camera_(header.world_from_camera),
      time_s_(header.time_s),
      camera_(header.motion.camera),
      camera_breaks_s_(times_of(header.motion.camera)) {
    for (const auto& [id, motion] : header.motion.objects) set_keys(id, motion.keys);
}

void FrameMotion::set_displacement(std::uint32_t id, Displacement displacement,
                                   std::vector<double> breaks_s) {
    screen_[id] = {std::move(displacement), std::move(breaks_s)};
}

void FrameMotion::set_keys(std::uint32_t id, const std::vector<TransformKey>& keys) {
    screen_.erase(id);
    rigid_[id] = MotionPath(keys);
    rigid_breaks_s_[id] = times_of(keys);
}

dmat4 FrameMotion::world_from_camera(double time_s) const {
    if (!camera_.moves(std::min(time_s, time_s_), std::max(time_s, time_s_))) return world_from_camera_;
    return camera_.at(time_s).matrix() * glm::inverse(camera_.at(time_s_).matrix()) * world_from_camera_;
}

RasterMap FrameMotion::map(std::uint32_t id, double from_s, double to_s) const {
    if (const auto screen = screen_.find(id); screen != screen_.end()) {
        const glm::dvec2 d = screen->second.displacement(to_s) - screen->second.displacement(from_s);
        dmat4 m(1);
        m[projection_ == Projection::perspective ? 2 : 3] += dvec4(d, 0, 0);
        return {m, projection_};
    }
    const double first = std::min(from_s, to_s), last = std::max(from_s, to_s);
    const auto rigid = rigid_.find(id);
    const bool object_moves = rigid != rigid_.end() && rigid->second.moves(first, last);
    if (!object_moves && !camera_moves(first, last)) return {dmat4(1), projection_};
    dmat4 world(1);
    if (object_moves)
        world = rigid->second.at(to_s).matrix() * glm::inverse(rigid->second.at(from_s).matrix());
    const dmat4 camera = glm::inverse(world_from_camera(to_s)) * world * world_from_camera(from_s);
    return {raster_from_camera_ * camera * camera_from_raster_, projection_};
}

std::vector<double> FrameMotion::breaks_s(std::uint32_t id) const {
    if (const auto screen = screen_.find(id); screen != screen_.end()) return screen->second.breaks_s;
    std::vector<double> out = camera_breaks_s_;
    if (const auto rigid = rigid_breaks_s_.find(id); rigid != rigid_breaks_s_.end())
        out.insert(out.end(), rigid->second.begin(), rigid->second.end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

bool FrameMotion::camera_moves(double open_s, double close_s) const {
    return camera_.moves(open_s, close_s);
}

std::vector<std::uint32_t> FrameMotion::moving_ids() const {
    std::vector<std::uint32_t> out;
    for (const auto& [id, motion] : rigid_) out.push_back(id);
    for (const auto& [id, motion] : screen_) out.push_back(id);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

}  // namespace postlens
