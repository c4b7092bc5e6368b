// A real lens in front of a picture that a pinhole framed: the same directions at the same pixels.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/focus_geometry.h"
#include "lens/prescription/traced_lens.h"

namespace postlens {

struct LensViewSettings {
    double focus_distance_m = 1;     ///< s > 0 from the pinhole; infinity allowed
    std::optional<double> f_number;  ///< absent: wide open
    Framing framing = Framing::keep;
    Film film;                    ///< of the pinhole camera
    double half_diagonal_px = 1;  ///< > 0; of the picture, which asks for no pixel farther from its middle
    double widest_tangent = 0;    ///< directions up to this one are asked for as well
};

/// A ray into the scene, in the axes of the raster: x to the right, y down.
struct ViewRay {
    glm::dvec2 lens_m{0};   ///< where it crosses the plane of the pinhole, which the lens stands about
    glm::dvec2 tangent{0};  ///< of its direction: what lies z' before that plane is at lens + z' tangent
    double weight = 0;      ///< see TracedLens::scene_ray
};

/// The picture is straight: each pixel shows what the pinhole shows there, as the ray through the middle of
/// the stop from the focused plane has it; the lens's distortion is taken out, as cameras do. Its vignetting,
/// its fall-off of light and everything that blurs stay. Framing::keep scales the film so that the view is
/// the traced one; `lens` has the film's pixels at the lens's focal length, `breathing` at the focus.
class LensView {
  public:
    /// Throws as TracedLens does, and Error(wrong_arguments) for a film out of range.
    LensView(const Prescription& lens, const LensViewSettings& settings);

    [[nodiscard]] const TracedLens& lens() const { return *lens_; }
    /// The thin lens of equal focal length, pupil and focus.
    [[nodiscard]] const FocusGeometry& geometry() const { return geometry_; }
    /// Film mm per tangent about the axis.
    [[nodiscard]] double film_scale_mm() const { return film_scale_mm_; }

    /// The ray that adds to the pixel in the direction `tangent` as the pinhole sees it; (u, v) in [0, 1)^2
    /// as TracedLens::scene_ray. False where it is lost. No allocation.
    [[nodiscard]] bool ray(glm::dvec2 tangent, glm::dvec2 uv, ViewRay& out) const noexcept;

    /// Light of the pixel in this direction, of an even scene at any distance, relative to that in the
    /// middle.
    [[nodiscard]] double light(double tangent) const;

    /// Where on the film, from its centre, light of this tangent's pixel lands; tangent >= 0.
    [[nodiscard]] double film_radius_mm(double tangent) const noexcept;
    /// Its derivative.
    [[nodiscard]] double film_mm_per_tangent(double tangent) const noexcept;
    /// The tangent of the pixel, in the axes of the camera (x right, y up), that shows a point of the film.
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
