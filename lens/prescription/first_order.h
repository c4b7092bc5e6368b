// The numbers of a lens for rays close to the axis.
#pragma once

#include "lens/prescription/prescription.h"

namespace postlens {

/// z in mm along the axis, positive towards the film: of things in front from the first surface's vertex, of
/// things behind from the last one's. What is behind lies in the medium there, of index n'. [born1999, 4.4]
struct FirstOrder {
    /// Equivalent focal length, one over the power; negative for a diverging lens. Of the same for any n': an
    /// image at infinity's angle t is efl t high, and the rear focal length is n' efl.
    double efl_mm = 0;
    double bfl_mm = 0;               ///< z of the rear focal point
    double ffl_mm = 0;               ///< z of the front focal point; negative where it lies in front
    double f_number = 0;             ///< |efl| / entrance pupil's diameter
    double entrance_pupil_z_mm = 0;  ///< image of the stop in what is before it; infinite: telecentric
    double entrance_pupil_diameter_mm = 0;
    double exit_pupil_z_mm = 0;  ///< image of the stop in what is behind it; infinite: telecentric
    double exit_pupil_diameter_mm = 0;
    double front_principal_z_mm = 0;  ///< ffl + efl
    double rear_principal_z_mm = 0;   ///< bfl - n' efl
    double stop_radius_mm = 0;        ///< wide open
    double film_distance_mm = 0;      ///< from the last vertex: the prescription's, else bfl
};

/// At the prescription's wavelength, or at another. Throws Error(invalid_input) for an afocal lens (power
/// times length below 1e-9) and an index out of [1, 5] at that wavelength.
[[nodiscard]] FirstOrder first_order(const Prescription& lens);
[[nodiscard]] FirstOrder first_order(const Prescription& lens, double wavelength_nm);

/// Heights y (mm) and n-times-slopes nu behind each surface.
struct ParaxialRay {
    double y_mm = 0, nu = 0;
};

/// The paraxial ray behind surface `surface`, at its vertex, from one that meets the first vertex plane in
/// air. [born1999, 4.4.1]
[[nodiscard]] ParaxialRay paraxial_ray(const Prescription& lens, double wavelength_nm, ParaxialRay at_first,
                                       std::size_t surface);

/// Where the image of the axial point `object_z_mm` (from the first vertex; -infinity) lies, from the last
/// vertex, mm.
[[nodiscard]] double paraxial_image_z_mm(const Prescription& lens, double wavelength_nm, double object_z_mm);

}  // namespace postlens
