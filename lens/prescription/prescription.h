// A lens prescription: surfaces, thicknesses, glasses and one stop.
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

/// Largest number of surfaces accepted. Photographic lenses have far fewer. The limit bounds the time per
/// ray, because a ray meets every surface.
inline constexpr std::size_t most_surfaces = 500;
/// Number of terms r^2, r^4, ... r^20 of an even asphere.
inline constexpr std::size_t asphere_terms = 10;

/// A surface of revolution about the z axis, which points from the scene to the film. Its sag at distance r
/// from the axis is c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + sum a_i r^(2i). The sag is the distance from
/// the vertex's plane, positive towards the film.
struct Surface {
    double curvature_per_mm = 0;  ///< c = 1 / radius; > 0: centre of curvature on the film's side
    double conic = 0;             ///< k; 0 sphere, -1 paraboloid
    std::array<double, asphere_terms> asphere{};  ///< a_1 (1/mm), a_2 (1/mm^3), ...
    double thickness_mm = 0;                      ///< to the next vertex, 0 or more; unused for the last
    double clear_radius_mm = std::numeric_limits<double>::infinity();  ///< > 0; infinity: not stated
    Glass glass;                                                       ///< medium behind the surface
    bool is_stop = false;
    int line = 0;  ///< line number in the file, for error messages; 0: unknown

    [[nodiscard]] bool is_asphere() const;
    /// Sag at distance r_mm from the axis. Not-a-number beyond the edge of the conic.
    [[nodiscard]] double sag_mm(double r_mm) const;
};

/// A lens prescription. Lengths are in mm, whatever unit the file uses. A prescription that
/// `read_prescription` returns has passed `check_prescription`.
struct Prescription {
    std::string file;    ///< file name for error messages
    std::string name;    ///< may be empty
    std::string source;  ///< patent or other origin; may be empty
    std::vector<Surface> surfaces;
    double wavelength_nm = d_line_nm;          ///< reference wavelength of the file's numbers
    std::optional<double> film_distance_mm;    ///< from the last vertex; absent: the rear focal point
    std::optional<double> object_distance_mm;  ///< from the first vertex; absent: infinity
    /// The stop's opening is given by at most one of these two numbers. If both are absent, the opening is
    /// the stop's clear radius.
    std::optional<double> entrance_pupil_diameter_mm, f_number;
    std::optional<double> stated_focal_length_mm;  ///< as stated in the file, for comparison
    std::vector<double> field_angles_deg;          ///< fields listed in the file; may be empty
    std::vector<std::string> notes;                ///< messages to the user about changes on reading

    /// Index into `surfaces`.
    [[nodiscard]] std::size_t stop() const;
    [[nodiscard]] double index_after(std::size_t surface) const {
        return surfaces[surface].glass.index(wavelength_nm);
    }
    /// Refractive index between the last surface and the film: 1 in air, more in an eye or under water.
    [[nodiscard]] double image_index(double at_nm) const { return surfaces.back().glass.index(at_nm); }
    /// Distance from the first vertex to the last.
    [[nodiscard]] double length_mm() const;
};

/// "FILE:LINE" of a surface.
[[nodiscard]] std::string place_of(const Prescription& lens, std::size_t surface);

/// Hash of the prescription. Prescriptions through which all rays take the same path have equal hashes.
[[nodiscard]] std::uint64_t fingerprint(const Prescription& lens);

/// Repairs neighbouring surfaces that cross within the smaller of their clear radii, by more than 1 % of this
/// radius. Both clear radii are reduced to the radius where the surfaces meet, and a note is added. Patents
/// and files of fisheye lenses contain such radii. Surfaces that would meet closer to the axis than 1 % of
/// this radius stay unchanged.
void clip_crossings(Prescription& lens);

/// Throws Error(invalid_input) "FILE:LINE: ..." unless all of these hold:
/// - there are 1 to `most_surfaces` surfaces and exactly one stop, whose width is stated;
/// - numbers are finite, thicknesses not negative, clear radii positive;
/// - indices at the wavelength are between 1 and 5;
/// - no two neighbouring surfaces cross within the smaller of their clear radii by more than 1 % of this
///   radius.
void check_prescription(const Prescription& lens);

}  // namespace postlens
