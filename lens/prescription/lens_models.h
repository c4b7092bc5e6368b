// Models of one lens, from the thin lens to the traced one, and how far each is from the traced.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/prescription/traced_lens.h"

namespace postlens {

/// From cheapest to dearest.
enum class LensModelKind {
    thin,        ///< (a) equal focal length, the pupil's disc at the pinhole
    thick,       ///< (b) principal planes and both pupils: every first-order effect
    polynomial,  ///< (c) low-order polynomials of pupil, depth and field; the pupil cut by three circles
    traced,      ///< (d) the lens itself
};
inline constexpr std::size_t lens_model_kinds = 4;
[[nodiscard]] const char* name_of(LensModelKind kind);

/// Where a ray lands, relative to the chief ray of its object point, and whether it gets there.
struct ModelRay {
    glm::dvec2 film_mm{0};
    bool passes = false;
};

/// Terms of the polynomial: functions of the pupil point (u, v) (in radii of the paraxial pupil, v along the
/// field), of the field T (its tangent over the largest) and of the defocus K (1/z' - 1/s, over its largest):
/// every product of these with 1 and with K. Mirror symmetry about the meridian leaves only terms odd in u
/// for x and even in u for y.
inline constexpr std::size_t pupil_terms = 13;
inline constexpr std::size_t polynomial_terms = 2 * pupil_terms;

/// One of the circles that bound the pupil: centre (0, (shift + shift_by_depth K) T + bend T^3), radius
/// radius + radius_by_depth K + growth T^2; in radii of the paraxial pupil.
struct PupilCircle {
    double shift = 0, bend = 0, radius = 1, growth = 0, shift_by_depth = 0, radius_by_depth = 0;
};

/// (c). Fitted by `fit_polynomial_lens`; plain numbers that a renderer or a file may keep.
struct PolynomialLens {
    double pupil_radius_mm = 1;        ///< that (u, v) are in units of
    double largest_tangent = 1;        ///< T = 1
    double inverse_focus_per_m = 0;    ///< 1/s
    double largest_defocus_per_m = 1;  ///< |K| = 1
    std::array<double, polynomial_terms> x_mm{}, y_mm{};
    std::array<PupilCircle, 3> circles{};

    /// depth_m > 0 or infinity; field tangent >= 0 along +y; pupil point in mm on the paraxial pupil's plane.
    [[nodiscard]] ModelRay ray(double depth_m, double tangent, glm::dvec2 pupil_mm) const;
    /// The values of the terms for x and for y.
    static void terms(double u, double v, double T, double K, std::array<double, polynomial_terms>& x,
                      std::array<double, polynomial_terms>& y);
};

/// Depths and fields that a model has to serve.
struct LensModelRange {
    std::vector<double> depths_m;  ///< > 0, infinity allowed
    std::vector<double> tangents;  ///< >= 0, along +y
};

/// `count` depths from a to b (infinity allowed) in equal steps of 1/z', and as many tangents from 0 to the
/// one whose chief ray lands `field_mm` from the film's centre. Throws Error(wrong_arguments) where a is not
/// positive or not below b, or where no chief ray reaches that height.
[[nodiscard]] LensModelRange lens_model_range(const TracedLens& lens, double a_m, double b_m, double field_mm,
                                              int count);

/// All cheaper models of one traced lens. `lens` and `traced` must outlive it.
class LensModels {
  public:
    LensModels(const Prescription& lens, const TracedLens& traced);
    void set_polynomial(const PolynomialLens& model) { polynomial_ = model; }

    /// (c) needs set_polynomial before.
    [[nodiscard]] ModelRay ray(LensModelKind kind, double depth_m, double tangent, glm::dvec2 pupil_mm) const;

    /// Root mean square distance, mm, of where the model's rays and the traced ones land (both relative to
    /// their chief rays), over an even grid of the pupil, for one depth and field. Light that only one of the
    /// two lets through counts with its distance from the nearest light of the pupil that both do: how far it
    /// would have to be moved.
    [[nodiscard]] double error_mm(LensModelKind kind, double depth_m, double tangent) const;
    /// The largest over a range.
    [[nodiscard]] double error_mm(LensModelKind kind, const LensModelRange& range) const;

    /// Film mm per pupil mm of the thick lens: `at_infinity` + `per_depth` / z'.
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

/// Least squares over a range, with Ceres: the landing points by linear terms, the pupil's edge by the three
/// circles, which begin as the stop, the first and the last rim. The same bits for equal input.
[[nodiscard]] PolynomialLens fit_polynomial_lens(const Prescription& lens, const TracedLens& traced,
                                                 const LensModelRange& range);

}  // namespace postlens
