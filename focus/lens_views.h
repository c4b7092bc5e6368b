// The lens as many points to look from, for the mean of that many views.
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
    glm::dvec2 lens{0};         ///< in units of the lens's radius, raster axes
    glm::dvec2 place{0.5};      ///< where in every pixel the view looks, px
    double light_before = 0.5;  ///< of the shutter's light, what has come in before
    LensShift shift;
};

/// Whether an aperture of a thin lens has this impulse response.
[[nodiscard]] bool has_points(const Impulse& impulse);
/// Throws Error(wrong_arguments) for those that none has.
void check_has_points(const Impulse& impulse);

/// `views` points of the aperture, as even as its light, each with its place in the pixel and its share of
/// the shutter's light: from the `first` on, of the Sobol points of five dimensions [joe2008], scrambled
/// [owen1995]. More views begin with the same ones. Sets are scrambled independently of each other: half the
/// squared difference of the means of two is an unbiased estimate of the squared error of either. Throws
/// Error(wrong_arguments) for a number below 1, and where a set would have more than most_lens_views.
[[nodiscard]] std::vector<LensViewPoint> lens_view_points(const Aperture& aperture,
                                                          const FocusGeometry& geometry, int views,
                                                          int set = 0, int first = 0);

}  // namespace postlens
