// The image of a real lens, framed like that of a pinhole: a pixel shows the same direction in both images.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/focus_geometry.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

struct LensViewSettings {
    double focus_distance_m = 1;     ///< s, from the pinhole; > 0, may be infinite
    std::optional<double> f_number;  ///< absent: wide open
    Framing framing = Framing::keep;
    Film film;                    ///< of the pinhole camera
    double half_diagonal_px = 1;  ///< > 0; distance of the farthest pixel from the image centre
    double widest_tangent = 0;    ///< the view covers directions up to at least this tangent
};

/// A ray into the scene, in the axes of the raster: x to the right, y down.
struct ViewRay {
    glm::dvec2 lens_m{0};   ///< intersection with the plane of the pinhole
    glm::dvec2 tangent{0};  ///< at distance z' in front of that plane, the ray is at lens_m + z' tangent
    double weight = 0;      ///< see TracedLens::scene_ray
};

/// A view through a lens whose distortion is corrected: points in the focus plane appear where the pinhole
/// image shows them. Vignetting and blur of the lens remain.
///
/// With Framing::keep, the film is made larger or smaller, so that the view shows the same part of the scene
/// as the pinhole image.
class LensView {
  public:
    /// Throws Error(wrong_arguments) if `settings.film` is out of range. Also throws the errors of
    /// TracedLens.
    LensView(const Prescription& lens, const LensViewSettings& settings);

    [[nodiscard]] const TracedLens& lens() const { return *lens_; }
    /// Returns the thin lens with the real lens's focal length, pupil and focus distance.
    [[nodiscard]] const FocusGeometry& geometry() const { return geometry_; }
    /// Returns the image scale of this lens without its distortion. It is the distance of an image point from
    /// the film centre, in mm, divided by the tangent of the object point's angle from the axis.
    [[nodiscard]] double film_scale_mm() const { return film_scale_mm_; }

    /// Computes the ray in the scene whose light reaches a pixel through one point of the lens. `tangent` is
    /// the direction that the pinhole sees in this pixel: (x, y) divided by the depth z'. `uv` in [0, 1)^2
    /// selects the lens point. Returns false if the lens blocks the ray. Does not allocate memory.
    [[nodiscard]] bool ray(glm::dvec2 tangent, glm::dvec2 uv, ViewRay& out) const noexcept;

    /// Returns the light that a pixel receives from a uniform scene, relative to the centre pixel. `tangent`
    /// is the tangent of the pixel's angle from the axis.
    [[nodiscard]] double light(double tangent) const;

    /// Returns how far from the film centre the chief ray from direction `tangent` >= 0 lands, in mm.
    [[nodiscard]] double film_radius_mm(double tangent) const noexcept;
    /// Derivative of film_radius_mm with respect to the tangent.
    [[nodiscard]] double film_mm_per_tangent(double tangent) const noexcept;
    /// Inverts the lens's distortion: converts a film point to the direction of the object point that appears
    /// there. The direction is returned as two tangents in camera axes (x right, y up).
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
