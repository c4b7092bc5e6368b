#include "lens/aperture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/fingerprint.h"
#include "core/threads.h"

namespace postlens {
namespace {

using glm::dvec2;

/// Limit of rim_scale, which is the lens radius divided by the radius of the rim that causes vignetting, as
/// seen in the plane of the lens. Below this limit, the rim is so large that it counts as blocking no light.
constexpr double smallest_rim_scale = 0.05;
/// Largest distance, in lens radii, between the aperture's outline and the polygon that replaces it when
/// random lens points are drawn.
constexpr double fine = 1e-5;

/// Inverts a cumulative distribution whose last value is 1. Returns the interval that contains u, and u's
/// position in it (0 to 1).
std::pair<std::size_t, double> step_of(const double* begin, const double* end, double u) {
    const double* at = std::min(std::upper_bound(begin, end, u), end - 1);
    const double before = at == begin ? 0 : at[-1];
    const double width = *at - before;
    return {static_cast<std::size_t>(at - begin),
            width > 0 ? std::clamp((u - before) / width, 0.0, 1.0) : 0.5};
}

/// Replaces the values by their running sums, scaled so that the last sum is 1.
void accumulate(std::vector<double>::iterator begin, std::vector<double>::iterator end) {
    double sum = 0;
    for (auto at = begin; at != end; ++at) *at = sum += *at;
    if (sum > 0) {
        for (auto at = begin; at != end; ++at) *at /= sum;
    }
}

dvec2 cell_half(const AperturePicture& p) {
    return dvec2(1.0 / std::max(p.width, p.height));
}

}  // namespace

Aperture::Aperture(const Impulse& impulse, std::optional<AperturePicture> picture)
    : impulse_(impulse), picture_(std::move(picture)) {
    check_impulse(impulse);
    half_extent_ = {1 / impulse.squeeze, 1};
    if (picture_) {
        const AperturePicture& p = *picture_;
        const dvec2 half = cell_half(p);
        half_extent_ *= dvec2(p.width, p.height) * half;
        farthest_ = glm::length(half_extent_);
        double sum = 0;
        for (const double light : p.light) {
            if (!(light >= 0 && std::isfinite(light)))
                fail(ExitCode::invalid_input,
                     "{}: no picture of an aperture (got a value of {}; expected 0 or more)",
                     impulse.file.string(), light);
            sum += light;
        }
        if (!(sum > 0 && std::isfinite(sum)))
            fail(ExitCode::invalid_input,
                 "{}: an aperture that lets nothing through (got a sum of {}; expected more "
                 "than 0)",
                 impulse.file.string(), sum);
        cell_light_ = p.light;
        most_light_ = *std::max_element(p.light.begin(), p.light.end());
        const auto width = static_cast<std::ptrdiff_t>(p.width);
        for (std::ptrdiff_t y = 0; y < p.height; ++y) {
            double row = 0;
            for (std::ptrdiff_t x = 0; x < width; ++x)
                row += p.light[static_cast<std::size_t>(y * width + x)];
            row_light_.push_back(row);
            accumulate(cell_light_.begin() + y * width, cell_light_.begin() + (y + 1) * width);
        }
        accumulate(row_light_.begin(), row_light_.end());
    } else {
        rim_ = whole(fine);
        // A round outline is replaced by a polygon of the same area. Its corners lie up to 1.5 % outside the
        // circle.
        constexpr double coarsest = 1.015;
        // Upper bound of the distance from the lens centre to the aperture's outline, in lens radii. A
        // squeeze below 1 makes the outline wider, because x coordinates of the aperture are divided by it.
        farthest_ = coarsest * std::max(1.0, 1 / impulse.squeeze);
        for (std::size_t i = 0; i < rim_.size(); ++i) {
            const dvec2 a = rim_[i], b = rim_[(i + 1) % rim_.size()];
            rim_light_.push_back(std::max(0.0, a.x * b.y - a.y * b.x));
        }
        accumulate(rim_light_.begin(), rim_light_.end());
    }
    if (varies_over_field() && !is_plain_disc()) lay_transmission_table();
}

bool Aperture::is_round() const {
    return impulse_.kind == ImpulseKind::disc && impulse_.squeeze == 1 && impulse_.cats_eye == 0 &&
           impulse_.spherical == 0;
}

bool Aperture::is_point_symmetric() const {
    if (impulse_.spherical != 0 || impulse_.cats_eye != 0 || picture_) return false;
    return impulse_.kind == ImpulseKind::disc || impulse_.blades % 2 == 0;
}

Outline Aperture::whole(double tolerance) const {
    Outline out = impulse_.kind == ImpulseKind::polygon
                      ? blades_outline(impulse_.blades, impulse_.rotation_deg, impulse_.roundness, tolerance)
                      : circle_outline(tolerance);
    for (dvec2& p : out) p.x /= impulse_.squeeze;
    return out;
}

Outline Aperture::second_rim(const dvec2& field, double tolerance, double rim_scale) const {
    if (rim_scale < smallest_rim_scale) return {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}};
    Outline out = circle_outline(tolerance);
    for (dvec2& p : out) p = (dvec2(p.x / impulse_.squeeze, p.y) - impulse_.cats_eye * field) / rim_scale;
    return out;
}

Outline Aperture::outline(const dvec2& field, double tolerance, double rim_scale) const {
    if (impulse_.cats_eye * field == dvec2(0) && rim_scale <= 1) return whole(tolerance);
    return intersection(whole(tolerance), second_rim(field, tolerance, rim_scale));
}

bool Aperture::passes(const dvec2& q, const dvec2& field, double rim_scale) const {
    if (rim_scale < smallest_rim_scale) return true;
    const dvec2 p = rim_scale * q + impulse_.cats_eye * field;
    return p.x * p.x * impulse_.squeeze * impulse_.squeeze + p.y * p.y <= 1;
}

// Returns the fraction of a round lens that cat's-eye vignetting leaves open at image position `field`. The
// vignetting is caused by a second rim, which is a circle of radius 1 / rim_scale in the plane of the lens.
double Aperture::share_of_disc(const dvec2& field, double rim_scale) const {
    if (rim_scale < smallest_rim_scale) return 1;
    // Computes the area in which two circles overlap: the lens and the vignetting rim. The lens has radius 1.
    // The rim has the radius r, and its centre is at distance d from the lens centre. Lengths are in lens
    // radii.
    const double r = 1 / rim_scale;
    const double d = impulse_.cats_eye * std::hypot(field.x * impulse_.squeeze, field.y) * r;
    if (d >= 1 + r) return 0;
    if (d <= std::abs(1 - r)) return std::min(1.0, r * r);
    const auto sector = [](double radius, double distance) {  // sector over the chord at this distance
        return radius * radius * std::acos(std::clamp(distance / radius, -1.0, 1.0));
    };
    const double near = (d * d + 1 - r * r) / (2 * d), far = d - near;
    const double half_chord = std::sqrt(std::max(0.0, 1 - near * near));
    return (sector(1, near) + sector(r, far) - d * half_chord) / std::numbers::pi;
}

double Aperture::share_passing(const dvec2& field, double rim_scale) const {
    if (!picture_) {
        constexpr double tolerance = 2e-4;
        return area(outline(field, tolerance, rim_scale)) / area(whole(tolerance));
    }
    const AperturePicture& p = *picture_;
    const dvec2 half = cell_half(p);
    double passing = 0, all = 0;
    for (int y = 0; y < p.height; ++y) {
        for (int x = 0; x < p.width; ++x) {
            const double light = p.light[static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                                         static_cast<std::size_t>(x)];
            all += light;
            const dvec2 q = dvec2(2 * x + 1 - p.width, 2 * y + 1 - p.height) * half;
            if (passes({q.x / impulse_.squeeze, q.y}, field, rim_scale)) passing += light;
        }
    }
    return passing / all;
}

void Aperture::lay_transmission_table() {
    const int steps = table_steps();
    const std::size_t side = static_cast<std::size_t>(steps) + 1;
    transmission_.resize(side * side * table_slices);
    parallel_for(transmission_.size(), [&](std::size_t i) {
        const std::size_t slice = i / (side * side), row = i % (side * side) / side, column = i % side;
        const dvec2 field(2.0 * static_cast<double>(column) / steps - 1,
                          2.0 * static_cast<double>(row) / steps - 1);
        transmission_[i] = static_cast<float>(
            share_passing(field, 1 - 0.5 * static_cast<double>(slice) / (table_slices - 1)));
    });
}

double Aperture::transmission(const dvec2& field, double rim_scale) const {
    if (!varies_over_field()) return 1;
    if (is_plain_disc()) return share_of_disc(field, rim_scale);
    const int steps = table_steps();
    const std::size_t side = static_cast<std::size_t>(steps) + 1;
    const auto place = [steps](double at) { return std::clamp((at + 1) / 2, 0.0, 1.0) * steps; };
    const double x = place(field.x), y = place(field.y);
    const auto i = std::min(static_cast<std::size_t>(x), side - 2),
               j = std::min(static_cast<std::size_t>(y), side - 2);
    const double fx = x - static_cast<double>(i), fy = y - static_cast<double>(j);
    const auto in_slice = [&](std::size_t slice) {
        const auto at = [&](std::size_t di, std::size_t dj) {
            return static_cast<double>(transmission_[(slice * side + j + dj) * side + i + di]);
        };
        return (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) + fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
    };
    const double k = std::clamp(rim_scale, 0.0, 1.0);
    if (k < 0.5) return 1 - 2 * k * (1 - in_slice(table_slices - 1));
    const double z = (1 - k) * 2 * (table_slices - 1);
    const auto slice = std::min(static_cast<std::size_t>(z), static_cast<std::size_t>(table_slices - 2));
    const double fz = z - static_cast<double>(slice);
    return (1 - fz) * in_slice(slice) + fz * in_slice(slice + 1);
}

dvec2 Aperture::sample(double u, double v) const {
    if (picture_) {
        const auto width = static_cast<std::size_t>(picture_->width);
        const auto [row, in_row] = step_of(row_light_.data(), row_light_.data() + row_light_.size(), v);
        const double* cells = cell_light_.data() + row * width;
        const auto [column, in_cell] = step_of(cells, cells + width, u);
        const dvec2 half = cell_half(*picture_);
        return {(2 * (static_cast<double>(column) + in_cell) - picture_->width) * half.x / impulse_.squeeze,
                (2 * (static_cast<double>(row) + in_row) - picture_->height) * half.y};
    }
    const auto [i, along] = step_of(rim_light_.data(), rim_light_.data() + rim_light_.size(), u);
    const dvec2 a = rim_[i], b = rim_[(i + 1) % rim_.size()];
    return std::sqrt(v) * (a + along * (b - a));
}

double Aperture::transmittance(const dvec2& q) const {
    const dvec2 p(q.x * impulse_.squeeze, q.y);
    if (picture_) {
        const dvec2 cell = (p / cell_half(*picture_) + dvec2(picture_->width, picture_->height)) / 2.0;
        if (!(cell.x >= 0 && cell.x < picture_->width && cell.y >= 0 && cell.y < picture_->height)) return 0;
        const std::vector<double>& light = picture_->light;
        return light[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(picture_->width) +
                     static_cast<std::size_t>(cell.x)] /
               most_light_;
    }
    if (q.x * q.x + q.y * q.y > farthest_ * farthest_) return 0;
    if (is_plain_disc()) return p.x * p.x + p.y * p.y <= 1 ? 1 : 0;
    for (std::size_t i = 0; i < rim_.size(); ++i) {
        const dvec2 a = rim_[i], side = rim_[(i + 1) % rim_.size()] - a;
        if (side.x * (q.y - a.y) - side.y * (q.x - a.x) < 0) return 0;
    }
    return 1;
}

std::uint64_t Aperture::fingerprint() const {
    Fingerprint out;
    const bool polygon = impulse_.kind == ImpulseKind::polygon;
    out.add(static_cast<std::uint64_t>(impulse_.kind));
    for (const double value :
         {polygon ? impulse_.blades : 0.0, polygon ? impulse_.rotation_deg : 0.0,
          polygon ? impulse_.roundness : 0.0, impulse_.squeeze, impulse_.cats_eye, impulse_.spherical})
        out.add(value);
    if (picture_) {
        out.add(static_cast<std::uint64_t>(picture_->width));
        for (const double light : picture_->light) out.add(light);
    }
    return out.value();
}

dvec2 disc_point(double u, double v) {
    const double a = 2 * u - 1, b = 2 * v - 1;
    if (a == 0 && b == 0) return {0, 0};
    constexpr double quarter = std::numbers::pi / 4;
    if (std::abs(a) > std::abs(b)) return {a * std::cos(quarter * b / a), a * std::sin(quarter * b / a)};
    return {b * std::sin(quarter * a / b), b * std::cos(quarter * a / b)};
}

}  // namespace postlens
