// Models of one lens (thin, thick, polynomial), and the error of each against traced rays.
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

/// A ray's landing point on the film, relative to that of the chief ray. The chief ray leaves the same object
/// point through the centre of the stop.
struct ModelRay {
    glm::dvec2 film_mm{0};
    bool passes = false;
};

/// Number of terms of the polynomial lens model, which predicts where a ray lands on the film. Its variables
/// are the ray's point (u, v) in the pupil, in pupil radii, and T, the tangent of the object point's angle
/// from the axis, divided by its largest value.
inline constexpr std::size_t pupil_terms = 13;
/// Number of coefficients of the polynomial lens model, for each coordinate of a ray's landing point. Each of
/// the pupil_terms terms occurs twice: once alone, and once multiplied by K, the defocus 1/z' - 1/s of the
/// object point divided by the largest defocus.
inline constexpr std::size_t polynomial_terms = 2 * pupil_terms;

/// A circle in the pupil of the polynomial lens model. Rays pass the lens if they lie in all of three such
/// circles. The circle's centre and radius, in pupil radii, depend on T, the tangent of the object point's
/// angle from the axis, and on its defocus K, each divided by its largest value.
/// - Centre: (0, (shift + shift_by_depth K) T + bend T^3).
/// - Radius: radius + radius_by_depth K + growth T^2.
struct PupilCircle {
    double shift = 0, bend = 0, radius = 1, growth = 0, shift_by_depth = 0, radius_by_depth = 0;
};

/// The polynomial model of a lens: polynomials that predict where rays land on the film, and circles that
/// tell which rays pass. The model is made by `fit_polynomial_lens`. It consists of plain numbers, so that it
/// can be stored or passed to a renderer.
struct PolynomialLens {
    double pupil_radius_mm = 1;        ///< unit of (u, v)
    double largest_tangent = 1;        ///< tangent at which T = 1
    double inverse_focus_per_m = 0;    ///< 1/s
    double largest_defocus_per_m = 1;  ///< |1/z' - 1/s| at which |K| = 1
    std::array<double, polynomial_terms> x_mm{}, y_mm{};
    std::array<PupilCircle, 3> circles{};

    /// Computes where a ray lands on the film according to this polynomial model. The ray starts at an object
    /// point above the axis, in the direction +y. `tangent` >= 0 is the tangent of this point's angle from
    /// the axis. The ray crosses the plane of the paraxial entrance pupil at `pupil_mm`.
    [[nodiscard]] ModelRay ray(double depth_m, double tangent, glm::dvec2 pupil_mm) const;
    /// Evaluates the polynomial's terms for the landing point's x and y.
    static void terms(double u, double v, double T, double K, std::array<double, polynomial_terms>& x,
                      std::array<double, polynomial_terms>& y);
};

/// The depths and field tangents of object points for which a lens model is fitted or tested.
struct LensModelRange {
    std::vector<double> depths_m;  ///< > 0, infinity allowed
    std::vector<double> tangents;  ///< >= 0, along +y
};

/// Returns a range of object points for which a lens model is fitted or tested. They form a grid of depths
/// and field tangents.
/// - Depths: `count` values from a_m to b_m, which may be infinite, in equal steps of inverse depth.
/// - Field tangents: `count` tangents of the angle from the axis, from 0 to a largest one. For this one, the
///   chief ray (through the stop's centre) lands at the distance field_mm from the film centre.
///
/// Throws Error(wrong_arguments) unless 0 < a_m < b_m, or if no chief ray lands at field_mm.
[[nodiscard]] LensModelRange lens_model_range(const TracedLens& lens, double a_m, double b_m, double field_mm,
                                              int count);

/// All models of one lens that predict where its rays land on the film (LensModelKind), and their errors. The
/// lens is given by its prescription `lens` and as `traced`. Both must outlive this object.
class LensModels {
  public:
    LensModels(const Prescription& lens, const TracedLens& traced);
    void set_polynomial(const PolynomialLens& model) { polynomial_ = model; }

    /// Returns where a ray lands on the film according to the lens model `kind`. `tangent` is the tangent of
    /// the object point's angle from the axis. The ray crosses the entrance pupil at `pupil_mm`. Call
    /// set_polynomial before using the polynomial model.
    [[nodiscard]] ModelRay ray(LensModelKind kind, double depth_m, double tangent, glm::dvec2 pupil_mm) const;

    /// Returns the error of a lens model for one object point, in mm. It is the RMS distance on the film
    /// between the landing points that the model predicts and those of traced rays. All landing points are
    /// relative to that of the chief ray.
    [[nodiscard]] double error_mm(LensModelKind kind, double depth_m, double tangent) const;
    /// Returns a lens model's largest error, in mm, over all depths and field positions of a range.
    [[nodiscard]] double error_mm(LensModelKind kind, const LensModelRange& range) const;

    /// Coefficients of the thick-lens model, which predicts by paraxial optics where rays land on the film. A
    /// ray from an object point at the depth z', in m, crosses the entrance pupil at the point p, in mm from
    /// its centre. Relative to the chief ray, it lands at
    ///
    ///     p * (thick_at_infinity() + thick_per_depth_m() / z')
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

/// Fits the polynomial model to a traced lens, by least squares. The rays for the fit start at object points
/// with the depths and field angles of `range`.
///
/// Equal input gives bit-identical results.
[[nodiscard]] PolynomialLens fit_polynomial_lens(const Prescription& lens, const TracedLens& traced,
                                                 const LensModelRange& range);

}  // namespace postlens
