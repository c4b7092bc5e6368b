#include "lens/traced/traced_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/job.h"
#include "lens/impulse.h"
#include "lens/traced/meridional_rotation.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr std::size_t rear_zones = 32;
constexpr int search_cells = 48;

double checked_stop_radius(const FirstOrder& wide_open, const TracedLensSettings& settings,
                           const Prescription& lens) {
    if (!settings.f_number) return wide_open.stop_radius_mm;
    const double n = *settings.f_number;
    // Relative tolerance by which n may be below the f-number of the fully open lens. The program displays
    // that f-number with four digits, possibly rounded down, and users may enter the displayed number.
    constexpr double rounding = 5e-4;
    if (!(n >= wide_open.f_number * (1 - rounding)) || !std::isfinite(n)) {
        fail(ExitCode::wrong_arguments,
             "--f-number: out of range (got {}; expected a finite number from {:.5g} on, which {} opens to)",
             n, wide_open.f_number, lens.file);
    }
    return wide_open.stop_radius_mm * std::min(1.0, wide_open.f_number / n);
}

double checked_wavelength(const Prescription& lens, const TracedLensSettings& settings) {
    const double nm = settings.wavelength_nm.value_or(lens.wavelength_nm);
    if (!(nm >= shortest_wavelength_nm && nm <= longest_wavelength_nm)) {
        fail(ExitCode::wrong_arguments, "--wavelength: out of range (got {} nm; expected {} to {})", nm,
             shortest_wavelength_nm, longest_wavelength_nm);
    }
    return nm;
}

dvec2 axis_of(dvec2 p) {
    const double length = glm::length(p);
    return length > 0 ? p / length : dvec2(0, 1);
}

}  // namespace

TracedLens::TracedLens(const Prescription& lens, const TracedLensSettings& settings)
    : settings_(settings),
      wavelength_nm_(checked_wavelength(lens, settings)),
      first_order_(postlens::first_order(lens, wavelength_nm_)),
      stack_(lens, wavelength_nm_, checked_stop_radius(first_order_, settings, lens)) {
    f_number_ = first_order_.f_number * first_order_.stop_radius_mm / stack_.stop_radius_mm();
    if (!(first_order_.efl_mm > 0)) {
        fail(ExitCode::invalid_input,
             "{}: the lens forms no real image (got a focal length of {:.6g} mm; expected more than 0)",
             lens.file, first_order_.efl_mm);
    }
    if (!std::isfinite(first_order_.entrance_pupil_z_mm) ||
        std::abs(first_order_.entrance_pupil_z_mm) > 1e9) {
        fail(ExitCode::invalid_input, "{}: the entrance pupil lies at infinity (expected a finite position)",
             lens.file);
    }
    if (!(settings.film_radius_mm > 0) || !std::isfinite(settings.film_radius_mm)) {
        fail(ExitCode::wrong_arguments,
             "--film-width: out of range (got {} mm of radius; expected more than 0)",
             settings.film_radius_mm);
    }
    film_index_squared_ = lens.image_index(wavelength_nm_) * lens.image_index(wavelength_nm_);
    set_focus(lens);
    find_rear_boxes();
    if (rear_boxes_.front().empty()) {
        // No ray from the centre of the film passes the lens, so an error is reported. Its message names the
        // surface at which a ray from infinity, at 0.7 of the pupil's radius, ends.
        LensRay ray =
            object_ray(HUGE_VAL, dvec2(0), dvec2(0, 0.35 * first_order_.entrance_pupil_diameter_mm));
        const RayEnd end = stack_.forward(ray);
        static constexpr const char* fates[] = {"passes", "misses", "is vignetted at",
                                                "is totally reflected at"};
        fail(ExitCode::invalid_input,
             "{}: no ray gets from the film's centre through the lens (a ray at 0.7 of the pupil {} surface "
             "{}; "
             "expected some to pass)",
             place_of(lens, end.surface), fates[static_cast<std::size_t>(end.fate)], end.surface + 1);
    }
}

LensRay TracedLens::object_ray(double depth_m, dvec2 field, dvec2 pupil_mm) const noexcept {
    // The object's depth and field angle are measured from the pinhole, the camera's viewpoint in the scene.
    // But the ray starts at the lens's entrance pupil. The two positions differ if the lens is moved to focus
    // it, because the entrance pupil then moves with the lens.
    const dvec3 pupil(pupil_mm, first_order_.entrance_pupil_z_mm);
    dvec3 direction(-field, 1);
    if (std::isfinite(depth_m)) {
        const double depth_mm = depth_m * 1000;
        const dvec3 object(field * depth_mm, pinhole_from_vertex_mm_ - depth_mm);
        direction = pupil - object;
        if (direction.z < 0) direction = -direction;
    }
    return {pupil, glm::normalize(direction)};
}

std::optional<dvec2> TracedLens::aim_at_stop(double depth_m, dvec2 field) const noexcept {
    const double tangent = glm::length(field);
    if (tangent == 0) return dvec2(0);
    const dvec2 axis = field / tangent;
    const double scale = 0.5 * first_order_.entrance_pupil_diameter_mm;
    // Finds the point of the entrance pupil at which the chief ray must be aimed, so that it passes through
    // the stop's centre. `height(y)` is the height at which a ray that is aimed at the pupil height y meets
    // the stop. The secant method finds the y for which this height is 0.
    const auto aimed = [&](double t, double start) -> std::optional<double> {
        const auto height = [&](double y) { return stack_.at_stop(object_ray(depth_m, {0, t}, {0, y})).y; };
        double y0 = start, f0 = height(y0), y1 = start + 0.01 * scale, f1 = height(y1);
        for (int step = 0; step < 64; ++step) {
            if (!std::isfinite(f0) || !std::isfinite(f1)) return std::nullopt;
            if (std::abs(f1) <= 1e-11 * stack_.stop_radius_mm()) return y1;
            if (f1 == f0) return std::nullopt;
            // Each step is limited to one pupil radius, because a ray that is aimed farther away misses the
            // lens.
            const double change = std::clamp(-f1 * (y1 - y0) / (f1 - f0), -scale, scale);
            y0 = y1;
            f0 = f1;
            y1 += change;
            f1 = height(y1);
            if (std::abs(change) <= 1e-14 * scale && std::isfinite(f1)) return y1;
        }
        return std::nullopt;
    };
    if (const auto y = aimed(tangent, 0)) return turned(dvec2(0, *y), axis);
    // The search for the ray through the stop's centre has failed. This can happen in a wide-angle lens,
    // because its entrance pupil moves with the field angle. So the search is repeated for field angles that
    // increase in steps from 0 to the given angle.
    constexpr int most_steps = 48;
    const double angle = std::atan(tangent);
    double before = 0, last = 0;
    for (int i = 1; i <= most_steps; ++i) {
        const double t = i == most_steps ? tangent : std::tan(angle * i / most_steps);
        // Each search begins at a point extrapolated from the previous two results.
        const auto y = aimed(t, 2 * last - before);
        if (!y) return std::nullopt;
        before = last;
        last = *y;
    }
    return turned(dvec2(0, last), axis);
}

double TracedLens::sharp_film_mm(const Prescription& lens, double distance_from_pupil_m) const {
    const double object_z = first_order_.entrance_pupil_z_mm - distance_from_pupil_m * 1000;
    const double image = paraxial_image_z_mm(lens, wavelength_nm_, object_z);
    if (!(image > 0) || !std::isfinite(image) || !(distance_from_pupil_m > 0) ||
        object_z > first_order_.ffl_mm) {
        fail(ExitCode::wrong_arguments,
             "--focus: too near (got {} m from the entrance pupil; expected more than {:.5g} m, where the "
             "image "
             "lies at infinity)",
             distance_from_pupil_m,
             std::max(0.0, first_order_.entrance_pupil_z_mm - first_order_.ffl_mm) * 1e-3);
    }
    double z = stack_.last_vertex_z_mm() + image;
    if (settings_.criterion == FocusCriterion::rms_spot) {
        // Moves the film to the position z at which the spot of an axial object point has the smallest root
        // mean square radius. Rays are traced at equal steps of the pupil radius y. Each ray has the weight
        // y, because it represents a ring of the pupil, whose area is proportional to y.
        double xu = 0, uu = 0;
        constexpr int rays = 256;
        for (int i = 0; i < rays; ++i) {
            const double y = (i + 0.5) / rays * 0.65 * first_order_.entrance_pupil_diameter_mm *
                             first_order_.f_number / f_number_;
            LensRay ray;
            ray.origin = dvec3(0, y, first_order_.entrance_pupil_z_mm);
            ray.direction = std::isinf(distance_from_pupil_m)
                                ? dvec3(0, 0, 1)
                                : glm::normalize(dvec3(0, y, distance_from_pupil_m * 1000));
            if (!stack_.forward(ray).passes()) continue;
            const double slope = ray.direction.y / ray.direction.z;
            xu += y * ray.at_z(z).y * slope;
            uu += y * slope * slope;
        }
        if (uu > 0) z -= xu / uu;
    }
    return z;
}

void TracedLens::set_focus(const Prescription& lens) {
    const double infinity = std::numeric_limits<double>::infinity();
    pinhole_from_vertex_mm_ = first_order_.entrance_pupil_z_mm;
    if (!settings_.focus_distance_m) {
        const bool stated =
            lens.film_distance_mm.has_value() && settings_.criterion == FocusCriterion::paraxial;
        film_from_vertex_mm_ =
            stated ? stack_.last_vertex_z_mm() + *lens.film_distance_mm : sharp_film_mm(lens, infinity);
        return;
    }
    const double s = *settings_.focus_distance_m;
    if (!(s > 0)) {
        fail(ExitCode::wrong_arguments, "--focus: out of range (got {} m; expected more than 0, or inf)", s);
    }
    if (settings_.move == FocusMove::film || std::isinf(s)) {
        film_from_vertex_mm_ = sharp_film_mm(lens, s);
        return;
    }
    // Computes the smallest distance on which the moving lens can focus. By Newton's equation, the distances
    // from the front focal point to the object and from the rear focal point to the image have the product n'
    // efl^2, so their sum is at least 2 sqrt(n') efl. This sum is the object's distance from the front focal
    // point of the lens before it moves.
    const double nearest_mm = first_order_.entrance_pupil_z_mm - first_order_.ffl_mm +
                              2 * std::sqrt(lens.image_index(wavelength_nm_)) * first_order_.efl_mm;
    const auto too_near = [&] {
        fail(ExitCode::wrong_arguments,
             "--focus: too near for a lens that moves as a whole (got {} m; expected more than about {:.4g} "
             "m)",
             s, nearest_mm * 1e-3);
    };
    if (s * 1e3 < nearest_mm) too_near();
    // The lens moves towards the scene by the distance e (extension_mm_) to focus on a point at the distance
    // s. film(d) is the film position, relative to the lens, at which an object at the distance d is in
    // focus. Because the film itself does not move, e must equal film(s - e) - film(infinity). The iteration
    // converges from below, because film(s - e) grows with e.
    const double rest = sharp_film_mm(lens, infinity);
    for (int step = 0; step < 200; ++step) {
        const double film = sharp_film_mm(lens, s - extension_mm_ * 1e-3);
        const double change = film - rest - extension_mm_;
        extension_mm_ += change;
        film_from_vertex_mm_ = film;
        if (std::abs(change) < 1e-10 * first_order_.efl_mm) {
            pinhole_from_vertex_mm_ += extension_mm_;
            return;
        }
    }
    too_near();
}

TracedLens::Box TracedLens::passing_rear(double film_radius_mm, const Box& from) const {
    const dvec3 film(0, film_radius_mm, film_from_vertex_mm_);
    const double z = stack_.last_vertex_z_mm();
    const dvec2 step = (from.high - from.low) / static_cast<double>(search_cells);
    // Tests whether rays from the film point `film` pass the lens. The rays are aimed at a grid of points in
    // the plane of the last lens vertex. The film point lies on the y axis, so the region of passing rays is
    // symmetric about x = 0. Therefore, the grid covers only x >= 0.
    constexpr int rows = search_cells + 1, columns = search_cells / 2 + 1;
    std::array<std::uint8_t, std::size_t{rows} * columns> passes{};
    const auto node = [&](int i, int j) { return from.low + step * dvec2(i + search_cells / 2, j); };
    const auto at = [](int i, int j) {
        return static_cast<std::size_t>(j) * columns + static_cast<std::size_t>(i);
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            LensRay ray{film, glm::normalize(dvec3(node(i, j), z) - film)};
            passes[at(i, j)] = stack_.backward(ray).passes() ? 1 : 0;
        }
    }
    // The grid points whose rays pass all lens surfaces may form several separate groups, of which only the
    // largest is used. The rays of other groups are stray light, which the mount of a real lens would block.
    Box box;
    std::size_t largest = 0;
    std::vector<int> patch;
    for (int first = 0; first < rows * columns; ++first) {
        if (passes[static_cast<std::size_t>(first)] == 0) continue;
        passes[static_cast<std::size_t>(first)] = 0;
        patch.assign(1, first);
        Box around{dvec2(HUGE_VAL), dvec2(-HUGE_VAL)};
        for (std::size_t k = 0; k < patch.size(); ++k) {
            const int i = patch[k] % columns, j = patch[k] / columns;
            around.low = glm::min(around.low, node(i, j));
            around.high = glm::max(around.high, node(i, j));
            for (const auto& [u, v] : {std::pair{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
                if (u < 0 || u >= columns || v < 0 || v >= rows) continue;
                std::uint8_t& next = passes[at(u, v)];
                if (next == 0) continue;
                next = 0;
                patch.push_back(v * columns + u);
            }
        }
        if (patch.size() <= largest) continue;
        largest = patch.size();
        box = around;
    }
    if (largest == 0) return {};
    const double x = box.high.x + step.x;
    return {{-x, box.low.y - step.y}, {x, box.high.y + step.y}};
}

void TracedLens::find_rear_boxes() {
    const double z = stack_.last_vertex_z_mm(), to_film = film_from_vertex_mm_ - z;
    const double to_pupil = film_from_vertex_mm_ - (z + first_order_.exit_pupil_z_mm);
    const double share = std::isfinite(to_pupil) && to_pupil != 0 ? std::abs(to_film / to_pupil) : 0;
    const double radius = 0.5 * first_order_.exit_pupil_diameter_mm * first_order_.f_number / f_number_;
    const double beam =
        share > 0 ? 2 * (radius * share + settings_.film_radius_mm * std::abs(1 - to_film / to_pupil))
                  : to_film / first_order_.f_number + 2 * settings_.film_radius_mm;
    const double clear = stack_.clear_radius_mm(stack_.size() - 1);
    const double widest = std::isfinite(clear) ? std::min(1.02 * clear, 4 * beam) : beam;
    std::vector<Box> at_radius;
    for (std::size_t i = 0; i <= rear_zones; ++i) {
        const double r = settings_.film_radius_mm * static_cast<double>(i) / rear_zones;
        Box box = passing_rear(r, {dvec2(-widest), dvec2(widest)});
        if (box.empty() && i == 0) box = {dvec2(-2 * radius * share), dvec2(2 * radius * share)};
        for (int again = 0; again < 3 && !box.empty(); ++again) {
            const Box closer = passing_rear(r, box);
            if (closer.empty()) break;
            box = closer;
        }
        at_radius.push_back(box);
    }
    for (std::size_t i = 0; i < rear_zones; ++i) {
        const Box &a = at_radius[i], &b = at_radius[i + 1];
        if (a.empty() || b.empty()) {
            rear_boxes_.push_back(a.empty() ? b : a);
        } else {
            rear_boxes_.push_back({glm::min(a.low, b.low), glm::max(a.high, b.high)});
        }
    }
    if (rear_boxes_.front().empty()) return;
    // Computes E0, the irradiance at the film centre for a scene that has the radiance 1 everywhere. Weights
    // of rays are divided by E0, so that such a scene gives the value 1 there. E0 is the mean weight of nodes
    // x nodes rays, and its relative error is about 1 / nodes^1.5.
    constexpr int nodes = 256;
    double sum = 0;
    SceneRay ray;
    axial_irradiance_sr_ = 1;
    for (int j = 0; j < nodes; ++j) {
        for (int i = 0; i < nodes; ++i) {
            if (scene_ray(dvec2(0), {(i + 0.5) / nodes, (j + 0.5) / nodes}, ray)) sum += ray.weight;
        }
    }
    axial_irradiance_sr_ = sum / (nodes * nodes);
    if (!(sum > 0)) rear_boxes_.front() = {};  // no sampled ray passes, so the lens counts as closed
}

bool TracedLens::scene_ray(dvec2 film_mm, dvec2 uv, SceneRay& out) const noexcept {
    const double r = glm::length(film_mm);
    const auto zone = static_cast<std::size_t>(r / settings_.film_radius_mm * rear_zones);
    if (!(r <= settings_.film_radius_mm)) return false;
    const Box& box = rear_boxes_[std::min(zone, rear_zones - 1)];
    if (box.empty()) return false;
    const dvec2 rear = turned(box.low + uv * (box.high - box.low), axis_of(film_mm));
    const double to_film = film_distance_mm();
    const dvec3 to_rear(rear - film_mm, -to_film);
    const double length = glm::length(to_rear);
    LensRay ray{dvec3(film_mm, film_from_vertex_mm_), to_rear / length};
    if (!stack_.backward(ray).passes()) return false;
    const double cosine = to_film / length;
    const double area = (box.high.x - box.low.x) * (box.high.y - box.low.y);
    out.origin_mm = ray.origin - dvec3(0, 0, pinhole_from_vertex_mm_);
    out.direction = ray.direction;
    out.weight = film_index_squared_ * area * cosine * cosine * cosine * cosine / (to_film * to_film) /
                 axial_irradiance_sr_;
    return true;
}

TracedLens::Box TracedLens::passing_pupil(double depth_m, dvec2 field, Box from) const {
    const dvec2 step = (from.high - from.low) / static_cast<double>(search_cells);
    Box box{dvec2(HUGE_VAL), dvec2(-HUGE_VAL)};
    for (int j = 0; j <= search_cells; ++j) {
        for (int i = 0; i <= search_cells; ++i) {
            const dvec2 p = from.low + step * dvec2(i, j);
            LensRay ray = object_ray(depth_m, field, p);
            if (!stack_.forward(ray).passes()) continue;
            box.low = glm::min(box.low, p);
            box.high = glm::max(box.high, p);
        }
    }
    if (!(box.high.y >= box.low.y)) return {};
    return {box.low - step, box.high + step};
}

bool TracedLens::impulse(double depth_m, dvec2 field, int nodes, PupilMesh& out) const {
    const auto count = static_cast<std::size_t>(nodes) * static_cast<std::size_t>(nodes);
    out.nodes = nodes;
    out.pupil_mm.assign(count, dvec2(0));
    out.film_mm.assign(count, dvec2(0));
    out.passes.assign(count, 0);
    out.weight.assign(count, 0);
    out.passing_area_mm2 = 0;
    const std::optional<dvec2> aim = aim_at_stop(depth_m, field);
    out.has_chief = false;
    if (aim) {
        LensRay chief = object_ray(depth_m, field, *aim);
        out.has_chief = stack_.forward(chief, Apertures::ignored).passes();
        if (out.has_chief) out.chief_film_mm = on_film(chief);
    }
    const double radius = 0.5 * first_order_.entrance_pupil_diameter_mm * first_order_.f_number / f_number_;
    const dvec2 centre = aim.value_or(dvec2(0));
    Box box = passing_pupil(depth_m, field, {centre - 2.5 * radius, centre + 2.5 * radius});
    if (box.empty() && std::isfinite(stack_.clear_radius_mm(0))) {
        // No ray passes the lens near `centre`, the point of the pupil at which the passing rays were
        // expected, because strong aberrations have moved the pupil. Therefore, the search is repeated among
        // all rays that meet the first lens surface.
        const LensRay through_vertex = object_ray(depth_m, field, dvec2(0));
        const dvec2 middle = dvec2(0) - (through_vertex.at_z(0) - dvec2(through_vertex.origin));
        const double clear = 1.1 * stack_.clear_radius_mm(0);
        box = passing_pupil(depth_m, field, {middle - clear, middle + clear});
    }
    if (box.empty()) return false;
    box = passing_pupil(depth_m, field, box);
    if (box.empty()) return false;
    const dvec2 step = (box.high - box.low) / static_cast<double>(nodes - 1);
    const LensRay middle = object_ray(depth_m, field, centre);
    const double middle_cosine = middle.direction.z;
    dvec2 sum(0);
    double passing = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const auto n = static_cast<std::size_t>(nodes);
        const std::size_t i = k % n, j = k / n;
        if (i == 0) throw_if_interrupted();
        const dvec2 p = box.low + step * dvec2(i, j);
        out.pupil_mm[k] = p;
        LensRay ray = object_ray(depth_m, field, p);
        // Weight of a ray: its share of the object point's light. This is the solid angle of a cell of the
        // grid in the pupil plane, relative to a cell at the pupil's centre. It is proportional to cos^3 of
        // the ray's angle from the axis, because other cells are farther away and inclined.
        const double ratio = ray.direction.z / middle_cosine;
        // Rays from an object at infinity are parallel, so they all have the weight 1.
        const double weight = std::isfinite(depth_m) ? ratio * ratio * ratio : 1;
        out.weight[k] = static_cast<float>(weight);
        if (!stack_.forward(ray).passes()) continue;
        out.passes[k] = 1;
        out.film_mm[k] = on_film(ray);
        sum += weight * out.film_mm[k];
        passing += weight;
    }
    if (passing == 0) return false;
    out.passing_area_mm2 = passing * step.x * step.y;
    if (!out.has_chief) out.chief_film_mm = sum / passing;
    for (std::size_t k = 0; k < count; ++k) {
        if (out.passes[k] != 0) out.film_mm[k] -= out.chief_film_mm;
    }
    return true;
}

}  // namespace postlens
