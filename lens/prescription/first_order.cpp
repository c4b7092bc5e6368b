#include "lens/prescription/first_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace postlens {
namespace {

// Ray transfer matrix of several surfaces: (y, nu) -> (a y + b nu, c y + d nu). y is the ray's height, and nu
// its slope times the refractive index.
struct Matrix {
    double a = 1, b = 0, c = 0, d = 1;
    void refract(double power) {
        c -= power * a;
        d -= power * b;
    }
    void move(double reduced_mm) {
        a += reduced_mm * c;
        b += reduced_mm * d;
    }
};

double vertex_curvature(const Surface& s) {
    return s.curvature_per_mm + 2 * s.asphere[0];
}

double checked_index(const Prescription& lens, std::size_t i, double wavelength_nm) {
    const double n = lens.surfaces[i].glass.index(wavelength_nm);
    if (!(n >= 1 && n <= 5)) {
        fail(ExitCode::invalid_input,
             "{}: index after surface {} is out of range at {} nm (got {}; expected 1 to 5)",
             place_of(lens, i), i + 1, wavelength_nm, n);
    }
    return n;
}

// Returns the transfer matrix of the surfaces `begin` to `end - 1`, including the refraction at the first and
// the last.
Matrix between(const Prescription& lens, double wavelength_nm, std::size_t begin, std::size_t end) {
    Matrix m;
    double n = begin == 0 ? 1 : checked_index(lens, begin - 1, wavelength_nm);
    for (std::size_t i = begin; i < end; ++i) {
        const double after = checked_index(lens, i, wavelength_nm);
        m.refract((after - n) * vertex_curvature(lens.surfaces[i]));
        n = after;
        if (i + 1 < end) m.move(lens.surfaces[i].thickness_mm / n);
    }
    return m;
}

}  // namespace

FirstOrder first_order(const Prescription& lens) {
    return first_order(lens, lens.wavelength_nm);
}

FirstOrder first_order(const Prescription& lens, double wavelength_nm) {
    const std::size_t count = lens.surfaces.size(), stop = lens.stop();
    const Matrix all = between(lens, wavelength_nm, 0, count);
    // The lens is afocal if its power times its length is below 1e-9.
    const double scale_mm = std::max(lens.length_mm(), 1e-3);
    if (!(std::abs(all.c) * scale_mm > 1e-9) || !std::isfinite(all.c)) {
        fail(ExitCode::invalid_input,
             "{}: the lens is afocal (got a power of {:.3g} per mm; expected one that forms an image)",
             lens.file, -all.c);
    }
    const double behind = lens.image_index(wavelength_nm);
    FirstOrder out;
    out.efl_mm = -1 / all.c;
    out.bfl_mm = -behind * all.a / all.c;
    out.ffl_mm = all.d / all.c;
    out.front_principal_z_mm = out.ffl_mm + out.efl_mm;
    out.rear_principal_z_mm = out.bfl_mm - behind * out.efl_mm;
    out.film_distance_mm = lens.film_distance_mm.value_or(out.bfl_mm);
    Matrix front = between(lens, wavelength_nm, 0, stop);
    if (stop > 0) {
        front.move(lens.surfaces[stop - 1].thickness_mm / checked_index(lens, stop - 1, wavelength_nm));
    }
    const Matrix back = between(lens, wavelength_nm, stop, count);
    // Finds the position z of the entrance pupil, the image of the stop seen from the scene. A paraxial ray
    // with the height y and the angle nu at the first surface meets the stop at the height front.a y +
    // front.b nu. This is 0 for a ray with y = -z nu, which aims at the pupil's centre.
    out.entrance_pupil_z_mm = front.b / front.a;
    out.exit_pupil_z_mm = 0 - behind * back.b / back.d;  // 0, not -0, if the stop is the last surface
    double radius = lens.surfaces[stop].clear_radius_mm;
    if (lens.entrance_pupil_diameter_mm) radius = 0.5 * *lens.entrance_pupil_diameter_mm * std::abs(front.a);
    if (lens.f_number) radius = 0.5 * std::abs(out.efl_mm) / *lens.f_number * std::abs(front.a);
    out.stop_radius_mm = radius;
    out.entrance_pupil_diameter_mm = 2 * radius / std::abs(front.a);
    out.exit_pupil_diameter_mm = 2 * radius / std::abs(back.d);
    out.f_number = std::abs(out.efl_mm) / out.entrance_pupil_diameter_mm;
    return out;
}

ParaxialRay paraxial_ray(const Prescription& lens, double wavelength_nm, ParaxialRay at_first,
                         std::size_t surface) {
    const Matrix m = between(lens, wavelength_nm, 0, surface + 1);
    return {m.a * at_first.y_mm + m.b * at_first.nu, m.c * at_first.y_mm + m.d * at_first.nu};
}

double paraxial_image_z_mm(const Prescription& lens, double wavelength_nm, double object_z_mm) {
    const Matrix m = between(lens, wavelength_nm, 0, lens.surfaces.size());
    // At the first surface, a paraxial ray from the object point on the axis has the height 1 and the slope
    // t. Behind the last surface, its height is m.a + m.b t, and its slope is m.c + m.d t, divided by the
    // refractive index there. The image lies where this ray meets the axis.
    const double t = std::isinf(object_z_mm) ? 0 : -1 / object_z_mm;
    return -lens.image_index(wavelength_nm) * (m.a + m.b * t) / (m.c + m.d * t);
}

}  // namespace postlens
