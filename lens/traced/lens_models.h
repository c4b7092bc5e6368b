// Models of one lens, from the thin lens to the traced lens, and the error of each against the traced lens.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/traced/traced_lens.h"

namespace postlens {

/// Models of a lens, from the cheapest to the most expensive to evaluate.
enum class LensModelKind {
    thin,        ///< (a) thin lens of equal focal length, with its pupil at the pinhole
    thick,       ///< (b) principal planes and both pupils: all first-order effects
    polynomial,  ///< (c) low-order polynomials of pupil, depth and field; three circles bound the pupil
    traced,      ///< (d) rays traced through all surfaces
};
inline constexpr std::size_t lens_model_kinds = 4;
[[nodiscard]] const char* name_of(LensModelKind kind);

/// Landing point of a ray on the film, relative to the chief ray of its object point, and whether the ray
/// passes the lens.
struct ModelRay {
    glm::dvec2 film_mm{0};
    bool passes = false;
};

/// Number of terms of the polynomial. Terms are functions of the pupil point (u, v), in radii of the paraxial
/// pupil with v along the field, and of the field T, its tangent over the largest tangent. Each appears alone
/// and multiplied by the defocus K = 1/z' - 1/s, over its largest value. Mirror symmetry about the meridian
/// leaves only terms odd in u for x and even in u for y.
inline constexpr std::size_t pupil_terms = 13;
inline constexpr std::size_t polynomial_terms = 2 * pupil_terms;

/// One of the circles that bound the pupil, in radii of the paraxial pupil. Its centre is (0, (shift +
/// shift_by_depth K) T + bend T^3), its radius is radius + radius_by_depth K + growth T^2.
struct PupilCircle {
    double shift = 0, bend = 0, radius = 1, growth = 0, shift_by_depth = 0, radius_by_depth = 0;
};

/// The polynomial model of a lens (LensModelKind::polynomial), fitted by `fit_polynomial_lens`. It consists
/// of plain numbers, which can be stored in a file or passed to a renderer.
struct PolynomialLens {
    double pupil_radius_mm = 1;        ///< unit of (u, v)
    double largest_tangent = 1;        ///< tangent at which T = 1
    double inverse_focus_per_m = 0;    ///< 1/s
    double largest_defocus_per_m = 1;  ///< |1/z' - 1/s| at which |K| = 1
    std::array<double, polynomial_terms> x_mm{}, y_mm{};
    std::array<PupilCircle, 3> circles{};

    /// Evaluates the model for depth_m > 0 or infinity, a field tangent >= 0 along +y, and a pupil point in
    /// mm on the plane of the paraxial pupil.
    [[nodiscard]] ModelRay ray(double depth_m, double tangent, glm::dvec2 pupil_mm) const;
    /// Evaluates the terms for x and for y.
    static void terms(double u, double v, double T, double K, std::array<double, polynomial_terms>& x,
                      std::array<double, polynomial_terms>& y);
};

/// Depths and fields for which a model is fitted or its error measured.
struct LensModelRange {
    std::vector<double> depths_m;  ///< > 0, infinity allowed
    std::vector<double> tangents;  ///< >= 0, along +y
};

/// Returns `count` depths from a to b (infinity allowed) in equal steps of 1/z', and as many tangents from 0
/// to that whose chief ray lands `field_mm` from the centre of the film. Throws Error(wrong_arguments) if a
/// is not positive or not below b, or if no chief ray reaches that height.
[[nodiscard]] LensModelRange lens_model_range(const TracedLens& lens, double a_m, double b_m, double field_mm,
                                              int count);

/// All models of one lens. `lens` and `traced` must outlive this object.
class LensModels {
  public:
    LensModels(const Prescription& lens, const TracedLens& traced);
    void set_polynomial(const PolynomialLens& model) { polynomial_ = model; }

    /// Landing point of a ray by the given model. The polynomial model needs a previous call of
    /// set_polynomial.
    [[nodiscard]] ModelRay ray(LensModelKind kind, double depth_m, double tangent, glm::dvec2 pupil_mm) const;

    /// Root mean square distance, mm, between the landing points of the model's rays and of the traced rays
    /// (both relative to their chief rays), over a uniform grid of the pupil, for one depth and field. A ray
    /// that only one of the two transmits counts with its distance from the nearest ray of the pupil that
    /// both transmit: the distance by which its light would have to move.
    [[nodiscard]] double error_mm(LensModelKind kind, double depth_m, double tangent) const;
    /// Largest error over a range.
    [[nodiscard]] double error_mm(LensModelKind kind, const LensModelRange& range) const;

    /// Displacement on the film per displacement on the pupil, of the thick lens, mm per mm: `at_infinity` +
    /// `per_depth` / z'.
    [[nodiscard]] double thick_at_infinity() const { return thick_at_infinity_; }
    [[nodiscard]] double thick_per_depth_m() const { return thick_per_depth_m_; }

  private:
    const TracedLens* traced_;
    std::optional<PolynomialLens> polynomial_;
    double pupil_radius_mm_ = 0;
    double thin_film_mm_ = 0;  ///< V
    double inverse_focus_per_m_ = 0;
    double thick_at_infinity_ = 0, thick_per_depth_m_ = 0;
};

/// Fits the polynomial model to a traced lens over a range of depths and fields, by least squares with Ceres.
/// Landing points are fitted by linear terms. The edge of the pupil is fitted by three circles, whose initial
/// values are the images of the stop and of the first and last rim. Results are bit-identical for equal
/// input.
[[nodiscard]] PolynomialLens fit_polynomial_lens(const Prescription& lens, const TracedLens& traced,
                                                 const LensModelRange& range);

}  // namespace postlens
