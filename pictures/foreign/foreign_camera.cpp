#include "pictures/foreign/foreign_camera.h"

#include <cmath>
#include <fmt/format.h>
#include <glm/glm.hpp>

#include "core/error.h"

namespace postlens {
namespace {

bool usable(double value) {
    return value > 0 && std::isfinite(value);
}

std::optional<double> checked(const std::optional<double>& value, const char* option) {
    if (value && !usable(*value)) {
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected more than 0)", option, *value);
    }
    return value;
}

/// Returns the value of an attribute, or empty if the attribute is absent or its value cannot be used.
std::optional<double> attribute(const ForeignFile& file, std::size_t part, const char* name) {
    const auto value = file.number(part, name);
    return value && usable(*value) ? value : std::nullopt;
}

/// Converts a matrix for row vectors, p' = p M, to a glm matrix for column vectors.
glm::dmat4 transposed(const Matrix44& m) {
    glm::dmat4 out;
    std::size_t i = 0;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) out[row][column] = m[i++];
    }
    return out;
}

/// Returns the matrix that projects column vectors from camera space to NDC. glm stores elements as
/// projection[column][row]. Returns empty if the matrices are degenerate.
std::optional<glm::dmat4> projection_of(const Matrix44& world_to_camera, const Matrix44& world_to_ndc) {
    const glm::dmat4 camera = transposed(world_to_camera);
    if (!(std::abs(glm::determinant(camera)) > 1e-12)) return std::nullopt;
    const glm::dmat4 out = transposed(world_to_ndc) * glm::inverse(camera);
    return usable(std::abs(out[0][0])) ? std::optional(out) : std::nullopt;
}

/// Returns true if depth does not affect the homogeneous coordinate w, as in a parallel projection.
bool is_parallel(const glm::dmat4& projection) {
    return !(std::abs(projection[2][3]) > 1e-9);
}

std::optional<double> view_of(const ForeignFile& file, std::size_t part, std::vector<std::string>& assumed) {
    const auto camera = file.matrix(part, "worldToCamera"), ndc = file.matrix(part, "worldToNDC");
    if (camera && ndc) {
        if (const auto tangent = half_width_tangent(*camera, *ndc)) return tangent;
        const auto projection = projection_of(*camera, *ndc);
        if (projection && is_parallel(*projection) && usable(std::abs((*projection)[3][3]))) {
            assumed.emplace_back(
                "the file's camera is orthographic, which has no lens: a perspective view is assumed "
                "(--film-distance)");
        }
    }
    // The OpenEXR library writes a screenWindowWidth of 1 if the program sets none, so the value 1 is
    // ignored.
    const auto width = attribute(file, part, "screenWindowWidth");
    if (width && *width != 1) return *width / 2;
    return std::nullopt;
}

}  // namespace

std::optional<double> half_width_tangent(const Matrix44& world_to_camera, const Matrix44& world_to_ndc) {
    const auto projection = projection_of(world_to_camera, world_to_ndc);
    if (!projection || is_parallel(*projection)) return std::nullopt;
    const double x = std::abs((*projection)[0][0]), w = std::abs((*projection)[2][3]);
    // In normalised device coordinates, the image may extend from 0 to 1 or from -1 to 1, depending on the
    // program that wrote the file. `middle`, the horizontal coordinate of the image centre, tells which.
    // `half` is half of the range: 0.5 or 1.
    const double middle = std::abs((*projection)[2][0]) / w;
    const double half = middle > 0.25 && middle < 0.75 ? 0.5 : 1;
    const double tangent = half * w / x;
    return usable(tangent) ? std::optional<double>(tangent) : std::nullopt;
}

ForeignCamera foreign_camera(const ForeignFile& file, std::size_t part, const ForeignCameraChoice& choice) {
    ForeignCamera out;
    const auto assume = [&](const char* what, double value, const char* unit, const char* option) {
        out.assumed.push_back(
            fmt::format("{} is not in the file: {:g}{} is assumed ({})", what, value, unit, option));
        return value;
    };
    const auto sensor = file.pair(part, "sensorOverallDimensions");
    if (const auto asked = checked(choice.film_width_mm, "--film-width")) {
        out.film_width_mm = *asked;
    } else if (sensor && usable((*sensor)[0])) {
        out.film_width_mm = (*sensor)[0];
    } else {
        assume("the film's width", out.film_width_mm, " mm", "--film-width");
    }
    const auto nominal = attribute(file, part, "nominalFocalLength");
    const auto asked_focal = checked(choice.focal_length_mm, "--focal-length");
    if (const auto asked = checked(choice.film_distance_mm, "--film-distance")) {
        out.film_distance_mm = *asked;
    } else if (const auto pinhole = attribute(file, part, "pinholeFocalLength")) {
        out.film_distance_mm = *pinhole;
    } else if (const auto tangent = view_of(file, part, out.assumed)) {
        out.film_distance_mm = out.film_width_mm / (2 * *tangent);
    } else if (nominal) {
        out.film_distance_mm = *nominal;
    } else if (asked_focal) {
        out.film_distance_mm = *asked_focal;
        out.film_distance_from_focal_length = true;
    } else {
        out.film_distance_from_focal_length = true;
        assume("the film's distance", out.film_distance_mm, " mm", "--film-distance");
    }
    // screenWindowCenter has the same unit as screenWindowWidth. Its y points upwards.
    const auto centre = file.pair(part, "screenWindowCenter");
    const auto window = attribute(file, part, "screenWindowWidth");
    if (centre && window) {
        const double unit = out.film_width_mm / out.film_distance_mm / *window;
        const double x = (*centre)[0] * unit, y = -(*centre)[1] * unit;
        if (std::isfinite(x) && std::isfinite(y)) out.centre_x = x, out.centre_y = y;
    }
    out.focal_length_mm = asked_focal.value_or(nominal.value_or(out.film_distance_mm));
    if (const auto asked = checked(choice.metres_per_unit, "--metres-per-unit")) {
        out.metres_per_unit = *asked;
    } else {
        assume("the unit of depth", out.metres_per_unit, " m", "--metres-per-unit");
    }
    if (choice.depth_along) {
        out.depth_along = *choice.depth_along;
    } else {
        out.assumed.emplace_back("what Z is measured along is not in the file: the axis is assumed (--z)");
    }
    out.f_number = attribute(file, part, "aperture");
    if (const auto focus = file.number(part, "focus"); focus && *focus > 0) out.focus_m = focus;
    return out;
}

}  // namespace postlens
