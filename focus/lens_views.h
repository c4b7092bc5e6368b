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
    glm::dvec2 lens{0};     ///< in units of the lens's radius, raster axes
    glm::dvec2 place{0.5};  ///< where in every pixel the view looks, px
    LensShift shift;
};

/// Whether an aperture of a thin lens has this impulse response.
[[nodiscard]] bool has_points(const Impulse& impulse);
/// Throws Error(wrong_arguments) for those that none has.
void check_has_points(const Impulse& impulse);

/// `views` points of the aperture, as even as its light, each with its place in the pixel: together a
/// low-discrepancy set of four dimensions, the lens's part of which is a Vogel spiral [vogel1979] for a disc
/// and a lattice along the golden ratio for other apertures. Throws Error(wrong_arguments) for a number
/// outside 1..most_lens_views. `set`: 0, 1, ...; another set is turned about the axis by an irrational angle
/// and shifted in the pixel.
[[nodiscard]] std::vector<LensViewPoint> lens_view_points(const Aperture& aperture,
                                                          const FocusGeometry& geometry, int views,
                                                          int set = 0);

}  // namespace postlens
