// A real lens whose image is framed like a pinhole's image: each pixel shows the same direction as in the
// pinhole image.
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
    double half_diagonal_px = 1;  ///< > 0; largest distance of a pixel from the image centre
    double widest_tangent = 0;    ///< the view also covers directions up to this tangent
};

/// A ray into the scene, in the axes of the raster: x to the right, y down.
struct ViewRay {
    glm::dvec2 lens_m{0};   ///< intersection with the plane of the pinhole
    glm::dvec2 tangent{0};  ///< at distance z' in front of that plane, the ray is at lens_m + z' tangent
    double weight = 0;      ///< see TracedLens::scene_ray
};

/// A view through a lens, with the lens's distortion corrected as cameras correct it. For a point in the
/// plane of focus, the ray through the centre of the stop lands on the pixel that shows the same direction in
/// the pinhole image. Vignetting, the fall-off of light and all blur remain.
///
/// Framing::keep scales the film so that the field of view equals that of the traced pinhole image. The other
/// framings keep the size of the film's pixels: with `lens` the film is one focal length behind the lens,
/// with `breathing` it is where the focus distance requires it.
class LensView {
  public:
    /// Throws the errors of TracedLens, and Error(wrong_arguments) if a value of the film is out of range.
    LensView(const Prescription& lens, const LensViewSettings& settings);

    [[nodiscard]] const TracedLens& lens() const { return *lens_; }
    /// The thin lens with the same focal length, pupil and focus distance.
    [[nodiscard]] const FocusGeometry& geometry() const { return geometry_; }
    /// Paraxial scale of the image: mm on the film per unit of the field tangent.
    [[nodiscard]] double film_scale_mm() const { return film_scale_mm_; }

    /// Computes a ray that contributes to the pixel which shows the direction `tangent` in the pinhole image.
    /// (u, v) in [0, 1)^2 are as for TracedLens::scene_ray. Returns false if the ray is blocked. Does not
    /// allocate.
    [[nodiscard]] bool ray(glm::dvec2 tangent, glm::dvec2 uv, ViewRay& out) const noexcept;

    /// Light that the pixel in this direction receives from a uniform scene at any distance, relative to the
    /// light of the centre pixel.
    [[nodiscard]] double light(double tangent) const;

    /// Distance from the film centre, mm, at which the light of the pixel in the direction `tangent` >= 0
    /// lands.
    [[nodiscard]] double film_radius_mm(double tangent) const noexcept;
    /// Derivative of film_radius_mm.
    [[nodiscard]] double film_mm_per_tangent(double tangent) const noexcept;
    /// Inverse of the distortion: returns the tangent, in camera axes (x right, y up), of the pixel that
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
