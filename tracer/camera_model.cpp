#include "tracer/camera_model.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "records/motion/scene_limits.h"

namespace postlens {
namespace {

using glm::dvec3;

double half_tangent(double degrees) {
    return std::tan(degrees * std::numbers::pi / 360);
}

double positive(double value, const char* option, const char* unit) {
    if (!(value > 0) || !std::isfinite(value)) {
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected a positive number of {})", option,
             value, unit);
    }
    return value;
}

// Returns the distance, mm, from the lens to a film on which `pixels` pixels subtend the angle `degrees`.
// The angle is measured between the outer edges of the outermost pixels, or optionally between their centres.
double film_distance(const Camera& c, double degrees, double pitch_mm, int pixels) {
    const double film_mm = pitch_mm * (c.fov_between_pixel_centres ? pixels - 1 : pixels);
    return film_mm / 2 / half_tangent(degrees);
}

}  // namespace

CameraModel::CameraModel(const Camera& camera, double time_s, const CameraOverrides& overrides)
    : width(overrides.width.value_or(camera.width)),
      height(overrides.height.value_or(camera.height)),
      projection(camera.projection) {
    if (width < 1 || height < 1 || width > largest_raster_px || height > largest_raster_px) {
        fail(ExitCode::wrong_arguments, "--size: out of range (got {}x{}; expected 1 to {} px a side)", width,
             height, largest_raster_px);
    }
    if (projection == Camera::Projection::orthographic) {
        pixel_pitch_mm = camera.orthographic_width_m * 1000 / width;
    } else {
        const double film_width_mm = overrides.film_width_mm
                                         ? positive(*overrides.film_width_mm, "--film-width", "mm")
                                         : camera.film_width_mm;
        pixel_pitch_mm = film_width_mm / width;
        if (overrides.film_distance_mm) {
            film_distance_mm = positive(*overrides.film_distance_mm, "--film-distance", "mm");
        } else if (camera.focal_length_mm) {
            film_distance_mm = *camera.focal_length_mm;
        } else if (camera.horizontal_fov_degrees) {
            film_distance_mm = film_distance(camera, *camera.horizontal_fov_degrees, pixel_pitch_mm, width);
        } else if (camera.vertical_fov_degrees) {
            film_distance_mm = film_distance(camera, *camera.vertical_fov_degrees, pixel_pitch_mm, height);
        } else {
            film_distance_mm = 50;
        }
        if (!(film_distance_mm > 0)) {
            fail(ExitCode::wrong_arguments,
                 "--size: a field of view between pixel centres needs more than one pixel a side");
        }
    }

    if (projection == Camera::Projection::perspective) tangent_per_px = pixel_pitch_mm / film_distance_mm;

    glm::dmat4 base(1);
    forward = glm::normalize(camera.look_at - camera.position);
    right = glm::cross(forward, camera.up);
    if (!(glm::length(right) > 1e-12 * glm::length(camera.up)) || !std::isfinite(glm::length(forward))) {
        fail(ExitCode::invalid_input, "camera {}: position, look_at and up do not span a view", camera.name);
    }
    right = glm::normalize(right);
    base[0] = glm::dvec4(right, 0);
    base[1] = glm::dvec4(glm::cross(right, forward), 0);
    base[2] = glm::dvec4(-forward, 0);
    base[3] = glm::dvec4(camera.position, 1);
    rest_from_camera = base;
    world_from_camera = camera.keys.empty() ? base : transform_at(camera.keys, time_s) * base;
    right = glm::normalize(dvec3(world_from_camera[0]));
    down = -glm::normalize(dvec3(world_from_camera[1]));
    forward = -glm::normalize(dvec3(world_from_camera[2]));
    position = dvec3(world_from_camera[3]);
}

std::optional<glm::dvec2> CameraModel::place(const dvec3& point) const {
    if (projection == Camera::Projection::perspective) return place_at_infinity(point - position);
    const double px_per_m = 1e3 / pixel_pitch_mm;
    return glm::dvec2(0.5 * width + glm::dot(point - position, right) * px_per_m,
                      0.5 * height + glm::dot(point - position, down) * px_per_m);
}

std::optional<glm::dvec2> CameraModel::place_at_infinity(const dvec3& direction) const {
    const double depth = glm::dot(direction, forward);
    if (!(depth > 0)) return std::nullopt;
    return glm::dvec2(0.5 * width + glm::dot(direction, right) / (depth * tangent_per_px),
                      0.5 * height + glm::dot(direction, down) / (depth * tangent_per_px));
}

CameraRay CameraModel::ray(double x, double y) const {
    const double px = x - 0.5 * width, py = y - 0.5 * height;
    if (projection == Camera::Projection::orthographic) {
        const double metres_per_px = pixel_pitch_mm * 1e-3;
        return {position + (px * metres_per_px) * right + (py * metres_per_px) * down, forward, 1.0};
    }
    const double tx = px * tangent_per_px, ty = py * tangent_per_px;
    const double cosine = 1 / std::sqrt(1 + tx * tx + ty * ty);
    return {position, (forward + tx * right + ty * down) * cosine, cosine};
}

}  // namespace postlens
