// A real lens whose image has the framing of a pinhole: pixels show the same directions.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/focus_geometry.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

struct LensViewSettings {
    double focus_distance_m = 1;     ///< s > 0 from the pinhole; infinity allowed
    std::optional<double> f_number;  ///< absent: wide open
    Framing framing = Framing::keep;
    Film film;                    ///< of the pinhole camera
    double half_diagonal_px = 1;  ///< > 0; of the image: largest distance of a pixel from its centre
    double widest_tangent = 0;    ///< directions up to this one must be covered as well
};

/// A ray into the scene, in the axes of the raster: x to the right, y down.
struct ViewRay {
    glm::dvec2 lens_m{0};   ///< intersection with the plane of the pinhole
    glm::dvec2 tangent{0};  ///< direction: at depth z' before that plane the ray is at lens_m + z' tangent
    double weight = 0;      ///< see TracedLens::scene_ray
};

/// A view through a lens, corrected for distortion as cameras do it: the ray through the centre of the stop
/// from the plane in focus lands on the pixel that shows the same direction through the pinhole. Vignetting,
/// the fall-off of light and all blur remain.
///
/// Framing::keep scales the film so that the field of view is that of the trace. The other framings keep the
/// size of the film's pixels: with `lens` the film is at the lens's focal length, with `breathing` it is at
/// the focus.
class LensView {
  public:
    /// Throws the errors of TracedLens, and Error(wrong_arguments) for a film out of range.
    LensView(const Prescription& lens, const LensViewSettings& settings);

    [[nodiscard]] const TracedLens& lens() const { return *lens_; }
    /// The thin lens of equal focal length, pupil and focus.
    [[nodiscard]] const FocusGeometry& geometry() const { return geometry_; }
    /// Paraxial scale: mm on the film per unit of the field tangent.
    [[nodiscard]] double film_scale_mm() const { return film_scale_mm_; }

    /// Computes a ray that contributes to the pixel that the pinhole sees in the direction `tangent`; (u, v)
    /// in [0, 1)^2 as for TracedLens::scene_ray. Returns false if the ray is lost. No allocation.
    [[nodiscard]] bool ray(glm::dvec2 tangent, glm::dvec2 uv, ViewRay& out) const noexcept;

    /// Light that the pixel in this direction receives from a uniform scene at any distance, relative to the
    /// centre pixel.
    [[nodiscard]] double light(double tangent) const;

    /// Distance from the film centre, mm, at which light lands that belongs to the pixel in the direction
    /// `tangent`
    /// >= 0.
    [[nodiscard]] double film_radius_mm(double tangent) const noexcept;
    /// Derivative of film_radius_mm.
    [[nodiscard]] double film_mm_per_tangent(double tangent) const noexcept;
    /// Inverse of the distortion: the tangent, in the axes of the camera (x right, y up), of the pixel that
    /// shows a film point.
    [[nodiscard]] glm::dvec2 straightened(glm::dvec2 film_mm) const noexcept;

  private:
    void follow_chief_rays(const TracedLens& lens, double widest_tangent);

    std::optional<TracedLens> lens_;
    FocusGeometry geometry_;
    double film_scale_mm_ = 1;
    double tangent_step_ = 1;
    std::vector<double> film_radius_;  ///< mm, by steps of the tangent
};

}  // namespace postlens
