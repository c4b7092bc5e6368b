// A lens as its designer writes it down: surfaces, thicknesses, glasses, one stop.
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

/// More are refused: no photographic lens comes near, and every ray meets every surface.
inline constexpr std::size_t most_surfaces = 500;
/// Terms r^2, r^4, ... r^20 of an even asphere.
inline constexpr std::size_t asphere_terms = 10;

/// A surface of revolution about the z axis, which runs from the scene to the film. Its sag at the distance r
/// from the axis is c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + sum a_i r^(2i), positive towards the film.
struct Surface {
    double curvature_per_mm = 0;  ///< c = 1 / radius; positive: the centre is on the film's side
    double conic = 0;             ///< k; 0 sphere, -1 paraboloid
    std::array<double, asphere_terms> asphere{};  ///< a_1 (1/mm), a_2 (1/mm^3), ...
    double thickness_mm = 0;                      ///< to the next vertex, 0 or more; unused for the last
    double clear_radius_mm = std::numeric_limits<double>::infinity();  ///< > 0; infinity: not stated
    Glass glass;                                                       ///< of what follows
    bool is_stop = false;
    int line = 0;  ///< where it stands in its file, for errors; 0: unknown

    [[nodiscard]] bool is_asphere() const;
    /// Not a number beyond the edge of the conic.
    [[nodiscard]] double sag_mm(double r_mm) const;
};

/// Lengths in mm whatever the file's unit. A prescription from `read_prescription` has passed
/// `check_prescription`.
struct Prescription {
    std::string file;    ///< as errors call it
    std::string name;    ///< may be empty
    std::string source;  ///< patent or other origin; may be empty
    std::vector<Surface> surfaces;
    double wavelength_nm = d_line_nm;          ///< the one that numbers are stated at
    std::optional<double> film_distance_mm;    ///< from the last vertex; absent: the rear focal point
    std::optional<double> object_distance_mm;  ///< from the first vertex; absent: infinity
    /// How wide open it is; absent: the stop's clear radius says so. At most one of the two.
    std::optional<double> entrance_pupil_diameter_mm, f_number;
    std::optional<double> stated_focal_length_mm;  ///< what the file claims
    std::vector<double> field_angles_deg;          ///< what the file asks for; may be empty
    std::vector<std::string> notes;                ///< what was changed on reading, for users to know

    /// Index into `surfaces`.
    [[nodiscard]] std::size_t stop() const;
    [[nodiscard]] double index_after(std::size_t surface) const {
        return surfaces[surface].glass.index(wavelength_nm);
    }
    /// Of what is between the last surface and the film: 1 in air, more in an eye or under water.
    [[nodiscard]] double image_index(double at_nm) const { return surfaces.back().glass.index(at_nm); }
    /// From the first vertex to the last.
    [[nodiscard]] double length_mm() const;
};

/// "FILE:LINE" of a surface.
[[nodiscard]] std::string place_of(const Prescription& lens, std::size_t surface);

/// Equal for prescriptions of which no ray can tell one from the other.
[[nodiscard]] std::uint64_t fingerprint(const Prescription& lens);

/// Surfaces that cross within the smaller of their clear radii (by more than a hundredth of it) get a clear
/// radius that ends where they meet, and a note. Such radii stand in patents and in files of fisheyes. Left
/// as they are where they meet within a hundredth of it, on the axis that is.
void clip_crossings(Prescription& lens);

/// Throws Error(invalid_input) "FILE:LINE: ..." unless there are 1 to `most_surfaces` surfaces and exactly
/// one stop, numbers are finite, thicknesses not negative, clear radii positive, indices at the wavelength
/// between 1 and 5, no two neighbouring surfaces cross within the smaller of
/// their clear radii (by more than a hundredth of it), and something says how wide the stop is.
void check_prescription(const Prescription& lens);

}  // namespace postlens
