// Lens points, pixel positions and instants of views.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "reproject/raster_map.h"

namespace postlens {

inline constexpr int default_lens_views = 64;
inline constexpr int most_lens_views = 4096;

struct LensViewPoint {
    glm::dvec2 lens{0};         ///< lens point, in lens radii, along the raster axes
    glm::dvec2 place{0.5};      ///< sample position in every pixel, px
    double light_before = 0.5;  ///< fraction of the exposure that has passed at the view's instant
    LensShift shift;
};

/// Returns whether each lens point sees a sharp image, and the mean of these images has the same blur as the
/// impulse response. Only then can an image be made from views of single lens points. This is not so for
/// diffraction and for real lenses.
[[nodiscard]] bool has_points(const Impulse& impulse);
/// Throws Error(wrong_arguments) unless has_points is true for the impulse response.
void check_has_points(const Impulse& impulse);

/// Returns the lens points [first, first + views) of a set. Each lens point also has a sample position in the
/// pixel and an instant of the exposure. These five numbers are a point of a Sobol sequence [joe2008] with
/// Owen scrambling [owen1995]. The lens points are as dense as the aperture's transmittance; the positions
/// are uniformly distributed, and the instants as the shutter weights them.
///
/// Each set has its own random scrambling. Two sets are therefore independent, and the difference between
/// their mean images shows the noise. Throws Error(wrong_arguments) if `views` is below 1 or the set would
/// exceed most_lens_views.
[[nodiscard]] std::vector<LensViewPoint> lens_view_points(const Aperture& aperture,
                                                          const FocusGeometry& geometry, int views,
                                                          int set = 0, int first = 0);

}  // namespace postlens
