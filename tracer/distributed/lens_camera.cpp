#include "tracer/distributed/lens_camera.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/multiversion.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int lanes = 16;

}  // namespace

LensCamera::LensCamera(const Camera& camera, const CameraModel& model, const Settings& settings)
    : width_(model.width),
      height_(model.height),
      orthographic_(model.projection == Camera::Projection::orthographic),
      lens_(settings.lens),
      aperture_(settings.aperture && !settings.aperture->is_round() && settings.lens.aperture_radius_m > 0
                    ? settings.aperture
                    : nullptr),
      view_(settings.view),
      span_(settings.span),
      curve_(settings.curve),
      even_time_(settings.curve.is_box()),
      path_(camera.keys) {
    assert(!orthographic_ || lens_.aperture_radius_m == 0);
    const glm::dmat4& m = model.rest_from_camera;
    rest_ = {dvec3(m[3]), dvec3(m[0]), -dvec3(m[1]), -dvec3(m[2])};
    moves_ = path_.moves(span_.open_s, span_.close_s);
    still_ = frame_at(span_.open_s);
    optics_.half_width = 0.5F * static_cast<float>(width_);
    optics_.half_height = 0.5F * static_cast<float>(height_);
    optics_.tangent_per_px = orthographic_ ? 0.0F : static_cast<float>(1 / lens_.gain_px);
    optics_.metres_per_px = orthographic_ ? static_cast<float>(model.pixel_pitch_mm * 1e-3) : 0.0F;
    optics_.aperture_radius_m = static_cast<float>(lens_.aperture_radius_m);
    optics_.inverse_focus_per_m = static_cast<float>(lens_.inverse_focus_per_m);
}

LensCamera::Frame LensCamera::frame_at(double time_s) const {
    const MotionPath::Pose pose = path_.at(time_s);
    return {pose.point(rest_.position), pose.direction(rest_.right), pose.direction(rest_.down),
            pose.direction(rest_.forward)};
}

// Computes 16 rays from lens points, in the camera's frame and in single precision.
// Rounding moves a ray by at most 1e-4 px on the raster.
POSTLENS_MULTIVERSION void LensCamera::local_rays(const LensSamples& s, const Optics& optics, Local& out) {
    constexpr float quarter = std::numbers::pi_v<float> / 4;
    for (std::size_t i = 0; i < lanes; ++i) {
        const float a = 2 * s.lens_u[i] - 1, b = 2 * s.lens_v[i] - 1;
        const bool first = std::abs(a) > std::abs(b);
        const float radius = first ? a : b, other = first ? b : a;
        const float safe = radius == 0 ? 1.0F : radius;
        const float angle = quarter * (other / safe), square = angle * angle;
        // Taylor series. Up to 45 degrees, the errors are below 4e-7 (sine) and 3e-8 (cosine).
        const float sine =
            angle * (1 + square * (-1.0F / 6 + square * (1.0F / 120 + square * (-1.0F / 5040))));
        const float cosine =
            1 + square * (-0.5F + square * (1.0F / 24 + square * (-1.0F / 720 + square * (1.0F / 40320))));
        const float along = radius * cosine, across = radius * sine;
        const float qx = optics.aperture_radius_m * (first ? along : across);
        const float qy = optics.aperture_radius_m * (first ? across : along);
        const float px = s.x[i] - optics.half_width, py = s.y[i] - optics.half_height;
        // Each ray goes from a lens point (qx, qy), in m, to a point of the focus plane. The pinhole camera
        // shows the latter at (px, py), in px from the image centre. `out` gets the ray's direction as
        // tangents (tx, ty), and its start (qx, qy), in m.
        out.tx[i] = px * optics.tangent_per_px - qx * optics.inverse_focus_per_m;
        out.ty[i] = py * optics.tangent_per_px - qy * optics.inverse_focus_per_m;
        out.qx[i] = qx + px * optics.metres_per_px;
        out.qy[i] = qy + py * optics.metres_per_px;
    }
}

// Returns the image position, relative to the image centre, of a ray with this direction through the pinhole.
// The unit is half the image diagonal.
dvec2 LensCamera::field_of(const dvec2& tangent) const {
    return tangent * lens_.gain_px / (0.5 * std::hypot(width_, height_));
}

void LensCamera::local_rays_of_aperture(const LensSamples& s, Local& out,
                                        std::array<float, 16>& weight) const {
    for (std::size_t i = 0; i < lanes; ++i) {
        const dvec2 unit =
            aperture_->sample(static_cast<double>(s.lens_u[i]), static_cast<double>(s.lens_v[i]));
        weight[i] =
            local_ray(static_cast<double>(s.x[i]), static_cast<double>(s.y[i]), unit, i, out) ? 1.0F : 0.0F;
    }
}

bool LensCamera::local_ray(double x, double y, const dvec2& unit, std::size_t lane, Local& out) const {
    const dvec2 px(x - 0.5 * width_, y - 0.5 * height_);
    const dvec2 q = lens_.aperture_radius_m * unit;
    const double spherical = aperture_ ? aperture_->spherical_per_m() * glm::dot(unit, unit) : 0;
    const dvec2 tangent = px / lens_.gain_px - q * (lens_.inverse_focus_per_m + spherical);
    out.tx[lane] = static_cast<float>(tangent.x);
    out.ty[lane] = static_cast<float>(tangent.y);
    out.qx[lane] = static_cast<float>(q.x);
    out.qy[lane] = static_cast<float>(q.y);
    return !loses_rays() || aperture_->passes(unit, field_of(tangent));
}

void LensCamera::local_rays_of_view(const LensSamples& s, Local& out, std::array<float, 16>& weight) const {
    for (std::size_t i = 0; i < lanes; ++i) {
        const dvec2 tangent =
            dvec2(static_cast<double>(s.x[i]) - 0.5 * width_, static_cast<double>(s.y[i]) - 0.5 * height_) /
            lens_.gain_px;
        ViewRay ray{.lens_m = dvec2(0), .tangent = tangent, .weight = 0};
        const dvec2 uv(static_cast<double>(s.lens_u[i]), static_cast<double>(s.lens_v[i]));
        weight[i] = view_->ray(tangent, uv, ray) ? static_cast<float>(ray.weight) : 0.0F;
        out.tx[i] = static_cast<float>(ray.tangent.x);
        out.ty[i] = static_cast<float>(ray.tangent.y);
        out.qx[i] = static_cast<float>(ray.lens_m.x);
        out.qy[i] = static_cast<float>(ray.lens_m.y);
    }
}

POSTLENS_MULTIVERSION void LensCamera::world_rays(const Local& local, const Frame& frame, bool parallel,
                                                  float* const to[6]) {
    const glm::vec3 position(frame.position), right(frame.right), down(frame.down), forward(frame.forward);
    float* __restrict ox = to[0], * __restrict oy = to[1], * __restrict oz = to[2];
    float* __restrict dx = to[3], * __restrict dy = to[4], * __restrict dz = to[5];
    const float tangents = parallel ? 0.0F : 1.0F;
    for (std::size_t i = 0; i < lanes; ++i) {
        const float qx = local.qx[i], qy = local.qy[i];
        ox[i] = position.x + (qx * right.x + qy * down.x);
        oy[i] = position.y + (qx * right.y + qy * down.y);
        oz[i] = position.z + (qx * right.z + qy * down.z);
        const float tx = tangents * local.tx[i], ty = tangents * local.ty[i];
        const float x = forward.x + (tx * right.x + ty * down.x);
        const float y = forward.y + (tx * right.y + ty * down.y);
        const float z = forward.z + (tx * right.z + ty * down.z);
        const float scale = 1 / std::sqrt(x * x + y * y + z * z);
        dx[i] = x * scale;
        dy[i] = y * scale;
        dz[i] = z * scale;
    }
}

void LensCamera::add_rays(const LensSamples& samples, RayBatch& batch, std::vector<float>& weights) const {
    Local local;  // NOLINT(cppcoreguidelines-pro-type-member-init): local_rays fills it
    std::array<float, lanes> weight{};
    if (view_) {
        local_rays_of_view(samples, local, weight);
    } else if (aperture_) {
        local_rays_of_aperture(samples, local, weight);
    } else {
        local_rays(samples, optics_, local);
    }
    add_local(local, samples.time, weight, batch, weights);
}

void LensCamera::add_rays(const PointSamples& samples, RayBatch& batch, std::vector<float>& weights) const {
    assert(!view_);
    Local local;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled lane by lane
    std::array<float, lanes> weight{};
    for (std::size_t i = 0; i < lanes; ++i) {
        const auto x = static_cast<double>(samples.x[i]), y = static_cast<double>(samples.y[i]);
        if (!orthographic_) {
            weight[i] = local_ray(x, y, samples.lens[i], i, local) ? 1.0F : 0.0F;
            continue;
        }
        const auto metres_per_px = static_cast<double>(optics_.metres_per_px);
        local.tx[i] = local.ty[i] = 0;
        local.qx[i] = static_cast<float>((x - 0.5 * width_) * metres_per_px);
        local.qy[i] = static_cast<float>((y - 0.5 * height_) * metres_per_px);
        weight[i] = 1;
    }
    add_local(local, samples.time, weight, batch, weights);
}

void LensCamera::add_local(const Local& local, std::array<float, lanes> time,
                           const std::array<float, lanes>& weight, RayBatch& batch,
                           std::vector<float>& weights) const {
    const std::size_t first = batch.add_group();
    float* const to[6] = {batch.ox.data() + first, batch.oy.data() + first, batch.oz.data() + first,
                          batch.dx.data() + first, batch.dy.data() + first, batch.dz.data() + first};
    if (!even_time_ && (moves_ || batch.has_times)) {
        for (float& t : time) t = static_cast<float>(curve_.time(static_cast<double>(t)));
    }
    if (!moves_) {
        world_rays(local, still_, orthographic_, to);
    } else {
        for (std::size_t i = 0; i < lanes; ++i) {
            const Frame f = frame_at(span_.at(static_cast<double>(time[i])));
            const auto qx = static_cast<double>(local.qx[i]), qy = static_cast<double>(local.qy[i]);
            const auto tx = static_cast<double>(local.tx[i]), ty = static_cast<double>(local.ty[i]);
            const dvec3 o = f.position + qx * f.right + qy * f.down;
            const dvec3 d = glm::normalize(f.forward + tx * f.right + ty * f.down);
            for (int c = 0; c < 3; ++c) {
                to[c][i] = static_cast<float>(o[c]);
                to[3 + c][i] = static_cast<float>(d[c]);
            }
        }
    }
    if (batch.has_times)
        std::copy(time.begin(), time.end(), batch.time.begin() + static_cast<std::ptrdiff_t>(first));
    std::fill_n(batch.t_far.begin() + static_cast<std::ptrdiff_t>(first), lanes,
                std::numeric_limits<float>::infinity());
    if (!loses_rays()) return;
    weights.resize(first + lanes);
    for (std::size_t i = 0; i < lanes; ++i) {
        weights[first + i] = weight[i];
        if (weight[i] == 0) batch.t_far[first + i] = 0;  // a ray without weight hits nothing
    }
}

LensCamera::Ray LensCamera::ray(double x, double y, double lens_u, double lens_v, double time) const {
    Ray out;
    out.time = curve_.time(time);
    const Frame f = frame_at(span_.at(out.time));
    const double px = x - 0.5 * width_, py = y - 0.5 * height_;
    if (orthographic_) {
        const auto metres_per_px = static_cast<double>(optics_.metres_per_px);
        out.origin = f.position + px * metres_per_px * f.right + py * metres_per_px * f.down;
        out.direction = f.forward;
        return out;
    }
    if (view_) {
        ViewRay ray{.tangent = dvec2(px, py) / lens_.gain_px};
        out.weight = view_->ray(ray.tangent, {lens_u, lens_v}, ray) ? ray.weight : 0;
        out.origin = f.position + ray.lens_m.x * f.right + ray.lens_m.y * f.down;
        out.direction = glm::normalize(f.forward + ray.tangent.x * f.right + ray.tangent.y * f.down);
        return out;
    }
    const dvec2 unit = aperture_ ? aperture_->sample(lens_u, lens_v) : disc_point(lens_u, lens_v);
    const dvec2 q = lens_.aperture_radius_m * unit;
    const double spherical = aperture_ ? aperture_->spherical_per_m() * glm::dot(unit, unit) : 0;
    const double tx = px / lens_.gain_px - q.x * (lens_.inverse_focus_per_m + spherical);
    const double ty = py / lens_.gain_px - q.y * (lens_.inverse_focus_per_m + spherical);
    if (loses_rays() && !aperture_->passes(unit, field_of({tx, ty}))) out.weight = 0;
    out.origin = f.position + q.x * f.right + q.y * f.down;
    out.direction = glm::normalize(f.forward + tx * f.right + ty * f.down);
    return out;
}

dvec2 LensCamera::pinhole_px(double x, double y, const dvec2& unit, double t) const {
    if (orthographic_) return {x, y};
    const dvec2 middle(0.5 * width_, 0.5 * height_), q = lens_.aperture_radius_m * unit;
    const double spherical = aperture_ ? aperture_->spherical_per_m() * glm::dot(unit, unit) : 0;
    const dvec2 tangent =
        (dvec2(x, y) - middle) / lens_.gain_px - q * (lens_.inverse_focus_per_m + spherical);
    const double z = t / std::sqrt(1 + glm::dot(tangent, tangent));
    return middle + lens_.gain_px * (q / z + tangent);
}

dvec3 LensCamera::inverse_depth(const dvec3& world, const dvec3& normal) const {
    const dvec3 at = world - still_.position;
    const double depth = glm::dot(at, still_.forward), distance = glm::dot(at, normal);
    if (orthographic_ || depth == 0 || distance == 0) return dvec3(0);
    const double scale = 1 / (lens_.gain_px * distance);
    return {1 / depth, scale * glm::dot(normal, still_.right), scale * glm::dot(normal, still_.down)};
}

double LensCamera::px_per_m(const dvec3& world, double time_s) const {
    if (orthographic_) return 1 / static_cast<double>(optics_.metres_per_px);
    const Frame f = frame_at(time_s);
    const double distance = glm::length(world - f.position), depth = glm::dot(world - f.position, f.forward);
    if (!(depth > 0)) return 0;
    // Returns how many px of the image correspond to 1 m at the point: the film distance in px, `gain_px`,
    // divided by the depth. For a point far to the side, the depth is almost 0, so it counts as at least 2 %
    // of the point's distance.
    return lens_.gain_px / std::max(depth, 0.02 * distance);
}

}  // namespace postlens
