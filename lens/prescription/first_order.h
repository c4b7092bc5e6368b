// First-order (paraxial) properties of a lens.
#pragma once

#include "lens/prescription/prescription.h"

namespace postlens {

/// First-order properties of a lens [born1999, 4.4]. All positions z are in mm along the axis, positive
/// towards the film. Positions in object space, such as the entrance pupil, are measured from the vertex of
/// the first surface, and positions in image space from the vertex of the last.
struct FirstOrder {
    /// Equivalent focal length efl: an object at infinity, at a small angle t (rad) from the axis, has its
    /// image at the height efl * t. It is negative for a diverging lens. If the medium behind the lens has
    /// the refractive index n', the rear focal length is n' * efl.
    double efl_mm = 0;
    double bfl_mm = 0;               ///< z of the rear focal point
    double ffl_mm = 0;               ///< z of the front focal point; negative in front of the lens
    double f_number = 0;             ///< |efl| / diameter of the entrance pupil
    double entrance_pupil_z_mm = 0;  ///< image of the stop in object space; infinite: telecentric
    double entrance_pupil_diameter_mm = 0;
    double exit_pupil_z_mm = 0;  ///< image of the stop in image space; infinite: telecentric
    double exit_pupil_diameter_mm = 0;
    double front_principal_z_mm = 0;  ///< ffl + efl
    double rear_principal_z_mm = 0;   ///< bfl - n' efl
    double stop_radius_mm = 0;        ///< wide open
    double film_distance_mm = 0;      ///< from the last vertex; bfl if the prescription gives none
};

/// Computes the first-order properties of a lens at a wavelength, by default the prescription's.
///
/// Throws Error(invalid_input) for a refractive index outside [1, 5], or for an afocal lens. A lens counts as
/// afocal if its power times its length from first to last surface is below 1e-9.
[[nodiscard]] FirstOrder first_order(const Prescription& lens);
[[nodiscard]] FirstOrder first_order(const Prescription& lens, double wavelength_nm);

/// A paraxial ray with its height y (mm) and nu, its slope times the refractive index.
struct ParaxialRay {
    double y_mm = 0, nu = 0;
};

/// Traces a paraxial ray [born1999, 4.4.1]. `at_first` is the ray in front of the lens, at the plane through
/// the vertex of the first surface. Returns the ray just behind `surface`, at the plane through that
/// surface's vertex.
[[nodiscard]] ParaxialRay paraxial_ray(const Prescription& lens, double wavelength_nm, ParaxialRay at_first,
                                       std::size_t surface);

/// Returns the image position of an axial object point, in mm from the last vertex. `object_z_mm` is in mm
/// from the first vertex, and may be -infinity.
[[nodiscard]] double paraxial_image_z_mm(const Prescription& lens, double wavelength_nm, double object_z_mm);

}  // namespace postlens
