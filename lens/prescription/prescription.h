// A lens prescription consists of surfaces, thicknesses, glasses and one stop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lens/prescription/glass.h"

namespace postlens {

/// Largest accepted number of surfaces. It bounds the time per ray, because a ray meets every surface.
inline constexpr std::size_t most_surfaces = 500;
/// Number of terms in the polynomial r^2, r^4, ... r^20 of an even asphere.
inline constexpr std::size_t asphere_terms = 10;

/// A lens surface: a surface of revolution about the z axis, which points from the scene to the film. At the
/// radius r from the axis, its distance from the plane through its vertex (the sag) is
///
///     c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + sum a_i r^(2i)
///
/// c is the curvature at the vertex, k the conic constant, and a_i (`asphere`) are the coefficients of an
/// even asphere.
struct Surface {
    double curvature_per_mm = 0;                  ///< c = 1 / radius; > 0 if the centre is on the film side
    double conic = 0;                             ///< k; 0 for a sphere, -1 for a paraboloid
    std::array<double, asphere_terms> asphere{};  ///< a_1 (1/mm), a_2 (1/mm^3), ...
    double thickness_mm = 0;                      ///< to the next vertex; not negative
    double clear_radius_mm = std::numeric_limits<double>::infinity();  ///< > 0; infinity: none given
    Glass glass;                                                       ///< medium behind the surface
    bool is_stop = false;
    int line = 0;  ///< line number in the file, for error messages; 0 if unknown

    [[nodiscard]] bool is_asphere() const;
    /// Returns how far the surface lies from its vertex along the axis (its sag), at distance r_mm from the
    /// axis. Returns NaN beyond the edge of the conic.
    [[nodiscard]] double sag_mm(double r_mm) const;
};

/// A lens prescription. Lengths are in mm, even if the file uses another unit.
struct Prescription {
    std::string file;    ///< file name for error messages
    std::string name;    ///< may be empty
    std::string source;  ///< patent or other origin; may be empty
    std::vector<Surface> surfaces;
    double wavelength_nm = d_line_nm;          ///< reference wavelength of the file's numbers
    std::optional<double> film_distance_mm;    ///< from the last vertex; absent: the rear focal point
    std::optional<double> object_distance_mm;  ///< from the first vertex; absent: infinity
    /// The diameter of the entrance pupil, in mm, and the f-number of the open lens. At most one of them is
    /// set. It determines how far the aperture stop opens. If none is set, the stop opens to the clear radius
    /// of its surface.
    std::optional<double> entrance_pupil_diameter_mm, f_number;
    std::optional<double> stated_focal_length_mm;  ///< as stated in the file, for comparison
    std::vector<double> field_angles_deg;          ///< fields listed in the file; may be empty
    std::vector<std::string> notes;                ///< messages to the user about changes made while reading

    /// Returns the index of the stop in `surfaces`.
    [[nodiscard]] std::size_t stop() const;
    [[nodiscard]] double index_after(std::size_t surface) const {
        return surfaces[surface].glass.index(wavelength_nm);
    }
    /// Returns the refractive index between the last surface and the film. It differs from 1 in an eye or
    /// under water.
    [[nodiscard]] double image_index(double at_nm) const { return surfaces.back().glass.index(at_nm); }
    /// Returns the distance from the first lens surface's vertex to the last.
    [[nodiscard]] double length_mm() const;
};

/// Returns "FILE:LINE" of a surface, for error messages.
[[nodiscard]] std::string place_of(const Prescription& lens, std::size_t surface);

/// Returns a hash of the numbers of `lens` that determine the paths of rays through it. Refractive indices
/// enter the hash at one wavelength, which the prescription states.
[[nodiscard]] std::uint64_t fingerprint(const Prescription& lens);

/// Repairs neighbouring surfaces that cross each other within their clear radii. If they overlap by more than
/// 1 % of the clear radii, both radii are reduced to the radius at which the surfaces meet, and a note for
/// the user is added to `lens.notes`. Surfaces that meet closer to the axis than 1 % of their clear radii
/// stay unchanged, and check_prescription rejects them.
void clip_crossings(Prescription& lens);

/// Throws Error(invalid_input) "FILE:LINE: ..." unless:
/// - There are 1 to `most_surfaces` surfaces and exactly one stop, whose opening is given.
/// - All numbers are finite, thicknesses are not negative, and clear radii are positive.
/// - Refractive indices at the prescription's wavelength are between 1 and 5.
/// - Neighbouring surfaces overlap by at most 1 % of the smaller clear radius.
void check_prescription(const Prescription& lens);

}  // namespace postlens
