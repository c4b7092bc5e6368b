// Plans the views of a motion-blurred image. A view is an image of the scene at a single instant, and the
// blurred image is the average of all views. The functions determine the number of views, and for each view
// its instant and its sample position within the pixels.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"

namespace postlens {

/// Largest number of different sample positions within a pixel, for antialiasing. Static surfaces are drawn
/// once for each of these positions.
inline constexpr int most_places = 64;

/// Numbers of instants for automatic settings. Moving objects are blurred by averaging views, which are
/// images at single instants of the exposure. The numbers are prime, so that the views show a periodic motion
/// at as many different phases as possible.
inline constexpr std::array automatic_views{131, 257, 521};
inline constexpr int most_views = 4096;  ///< largest number of instants (views) that a user may set

/// Throws Error(wrong_arguments) for a number outside 1..most_views.
void check_views(const std::optional<int>& views);

/// Returns the element with the index j of a (0, 2)-sequence [sobol1967], which is a sample position in a
/// pixel, in px. Positions with successive indices are far apart, so a few of them already cover the pixel
/// evenly. `places` is the number of all positions, a power of 2.
[[nodiscard]] glm::dvec2 place_in_pixel(std::uint32_t j, double places);

/// Returns the automatic number of instants (views) to average, for objects that move by up to `longest_px`:
/// at least one per 2 px, but no more than 521. docs/motion.md states the error.
[[nodiscard]] int views_for_way(double longest_px);

struct ShutterView {
    glm::dvec2 place{0.5, 0.5};  ///< sample position in the pixel, px
    double time_s = 0;
};
/// Returns an instant and a sample position in the pixel for each view of an exposure. The more light the
/// shutter transmits, the denser the instants are. The sample positions are spread over the pixel.
[[nodiscard]] std::vector<ShutterView> shutter_views(const ShutterCurve& curve, const Exposure& exposure,
                                                     int views);

}  // namespace postlens
