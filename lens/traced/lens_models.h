// Models of one lens, from the thin lens to the traced lens. Also computes the error of each model relative
// to the traced lens.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/traced/traced_lens.h"

namespace postlens {

/// The models of a lens, ordered from the fastest to the slowest.
enum class LensModelKind {
    thin,        ///< (a) thin lens of equal focal length, with its pupil at the pinhole
    thick,       ///< (b) principal planes and both pupils: all first-order effects
    polynomial,  ///< (c) low-order polynomials of pupil, depth and field; the pupil is bounded by three
                 ///< circles
    traced,      ///< (d) rays traced through all surfaces
};
inline constexpr std::size_t lens_model_kinds = 4;
[[nodiscard]] const char* name_of(LensModelKind kind);

/// The point where a ray lands on the film. It is relative to the landing point of the chief ray, which is
/// the ray from the same object point through the centre of the stop. `passes` is false if the lens blocks
/// the ray.
struct ModelRay {
    glm::dvec2 film_mm{0};
    bool passes = false;
};

/// Number of terms of the polynomial for each coordinate of the landing point. The terms depend on the pupil
/// point (u, v) and on the field T. The unit of u and v is the radius of the paraxial pupil, and v is in the
/// direction of the field. T is the field tangent (the tangent of the angle between object point and axis),
/// divided by its largest value.
///
/// Each term occurs twice: alone, and multiplied by the defocus K. K is 1/z' - 1/s for depth z' and focus
/// distance s, divided by its largest value. Lenses are mirror-symmetric about the plane u = 0. The
/// polynomial for x therefore has only terms that are odd in u, and the polynomial for y only terms that are
/// even in u.
inline constexpr std::size_t pupil_terms = 13;
inline constexpr std::size_t polynomial_terms = 2 * pupil_terms;

/// One of the three circles whose intersection is the pupil. Lengths are in radii of the paraxial pupil. T is
/// the field tangent and K the defocus, each divided by its largest value in PolynomialLens. The circle's
/// centre is (0, (shift + shift_by_depth K) T + bend T^3), and its radius is radius + radius_by_depth K +
/// growth T^2.
struct PupilCircle {
    double shift = 0, bend = 0, radius = 1, growth = 0, shift_by_depth = 0, radius_by_depth = 0;
};

/// The polynomial model of a lens (LensModelKind::polynomial), which `fit_polynomial_lens` returns. All
/// members are plain numbers, so the model can be stored in a file or passed to a renderer.
struct PolynomialLens {
    double pupil_radius_mm = 1;        ///< unit of (u, v)
    double largest_tangent = 1;        ///< tangent at which T = 1
    double inverse_focus_per_m = 0;    ///< 1/s
    double largest_defocus_per_m = 1;  ///< |1/z' - 1/s| at which |K| = 1
    std::array<double, polynomial_terms> x_mm{}, y_mm{};
    std::array<PupilCircle, 3> circles{};

    /// Evaluates the model. The depth must be positive and may be infinite. The field tangent is along +y and
    /// must not be negative. The pupil point is in mm on the plane of the paraxial pupil.
    [[nodiscard]] ModelRay ray(double depth_m, double tangent, glm::dvec2 pupil_mm) const;
    /// Evaluates the terms for x and for y.
    static void terms(double u, double v, double T, double K, std::array<double, polynomial_terms>& x,
                      std::array<double, polynomial_terms>& y);
};

/// The depths and fields for which a model is fitted or its error is measured.
struct LensModelRange {
    std::vector<double> depths_m;  ///< > 0, infinity allowed
    std::vector<double> tangents;  ///< >= 0, along +y
};

/// Returns `count` depths from a to b, in equal steps of the inverse depth, and `count` equally spaced field
/// tangents from 0 to the tangent at which the chief ray (the ray through the centre of the stop) lands
/// `field_mm` from the centre of the film. b may be infinite. Throws Error(wrong_arguments) unless 0 < a < b,
/// or if no chief ray lands at that distance.
[[nodiscard]] LensModelRange lens_model_range(const TracedLens& lens, double a_m, double b_m, double field_mm,
                                              int count);

/// All models of one lens. `lens` and `traced` must outlive this object.
class LensModels {
  public:
    LensModels(const Prescription& lens, const TracedLens& traced);
    void set_polynomial(const PolynomialLens& model) { polynomial_ = model; }

    /// Returns the landing point of a ray according to the given model. Call set_polynomial before using the
    /// polynomial model.
    [[nodiscard]] ModelRay ray(LensModelKind kind, double depth_m, double tangent, glm::dvec2 pupil_mm) const;

    /// Returns the root mean square error of the model's landing points, in mm, at one depth and field, over
    /// a uniform grid of the pupil. In both the model and the traced lens, landing points are relative to the
    /// chief ray.
    ///
    /// If a ray passes in only one of the two, its error is the distance on the film between its landing
    /// point and that of the nearest ray that passes in both.
    [[nodiscard]] double error_mm(LensModelKind kind, double depth_m, double tangent) const;
    /// Returns the largest error over all depths and fields of a range.
    [[nodiscard]] double error_mm(LensModelKind kind, const LensModelRange& range) const;

    /// In the thick-lens model, the ray through pupil point p lands on the film at p (thick_at_infinity() +
    /// thick_per_depth_m() / z'), where z' is the depth of the object point in m.
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
/// The landing points depend linearly on the coefficients of the polynomials. The pupil is the intersection
/// of three circles, whose initial values are the paraxial images of the stop and of the first and last rim.
/// Equal input gives bit-identical results.
[[nodiscard]] PolynomialLens fit_polynomial_lens(const Prescription& lens, const TracedLens& traced,
                                                 const LensModelRange& range);

}  // namespace postlens
