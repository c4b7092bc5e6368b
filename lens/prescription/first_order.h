// First-order (paraxial) properties of a lens.
#pragma once

#include "lens/prescription/prescription.h"

namespace postlens {

/// First-order properties of a lens [born1999, 4.4]. z is in mm along the axis, positive towards the film. In
/// front of the lens (object space) it is measured from the vertex of the first surface; behind the lens
/// (image space), from the vertex of the last surface. n' is the refractive index behind the lens.
struct FirstOrder {
    /// Equivalent focal length, 1 / power; negative for a diverging lens. Whatever n' is, an object at
    /// infinity at the small angle t from the axis has an image of height efl t. The rear focal length is n'
    /// efl.
    double efl_mm = 0;
    double bfl_mm = 0;               ///< z of the rear focal point
    double ffl_mm = 0;               ///< z of the front focal point; negative where it lies in front
    double f_number = 0;             ///< |efl| / diameter of the entrance pupil
    double entrance_pupil_z_mm = 0;  ///< image of the stop in object space; infinite: telecentric
    double entrance_pupil_diameter_mm = 0;
    double exit_pupil_z_mm = 0;  ///< image of the stop in image space; infinite: telecentric
    double exit_pupil_diameter_mm = 0;
    double front_principal_z_mm = 0;  ///< ffl + efl
    double rear_principal_z_mm = 0;   ///< bfl - n' efl
    double stop_radius_mm = 0;        ///< wide open
    double film_distance_mm = 0;      ///< from the last vertex; bfl if the prescription states none
};

/// Computes the properties at the prescription's wavelength, or at the given one. Throws Error(invalid_input)
/// for an afocal lens (power times length below 1e-9), and for a refractive index outside [1, 5] at that
/// wavelength.
[[nodiscard]] FirstOrder first_order(const Prescription& lens);
[[nodiscard]] FirstOrder first_order(const Prescription& lens, double wavelength_nm);

/// A paraxial ray: its height y (mm) and its slope times the refractive index, nu.
struct ParaxialRay {
    double y_mm = 0, nu = 0;
};

/// Returns the paraxial ray in the vertex plane of `surface`, after refraction there. `at_first` is the ray
/// in the vertex plane of the first surface, in air. [born1999, 4.4.1]
[[nodiscard]] ParaxialRay paraxial_ray(const Prescription& lens, double wavelength_nm, ParaxialRay at_first,
                                       std::size_t surface);

/// Position of the image of a point on the axis, mm from the last vertex. `object_z_mm` is measured from the
/// first vertex and may be -infinity.
[[nodiscard]] double paraxial_image_z_mm(const Prescription& lens, double wavelength_nm, double object_z_mm);

}  // namespace postlens
