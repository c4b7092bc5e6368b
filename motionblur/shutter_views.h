// Determines the number of views of an exposure, and each view's instant and sample position.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"

namespace postlens {

/// Largest number of sample positions in a pixel. Static surfaces are drawn once for each.
inline constexpr int most_places = 64;

/// Automatic numbers of views M. They are prime, because a motion that repeats k times shows only M / gcd(M,
/// k) phases.
inline constexpr std::array automatic_views{131, 257, 521};
inline constexpr int most_views = 4096;  ///< largest number of instants (views) that a user may set

/// Throws Error(wrong_arguments) for a number outside 1..most_views.
void check_views(const std::optional<int>& views);

/// Returns element j of a (0, 2)-sequence [sobol1967] as a sample position in the pixel, in px. Successive
/// positions are far apart. `places` is their number, a power of 2.
[[nodiscard]] glm::dvec2 place_in_pixel(std::uint32_t j, double places);

/// Returns the automatic number of views for objects that move by up to `longest_px`: one view per 2 px, if
/// possible. docs/motion.md states the error.
[[nodiscard]] int views_for_way(double longest_px);

struct ShutterView {
    glm::dvec2 place{0.5, 0.5};  ///< sample position in the pixel, px
    double time_s = 0;
};
/// Returns views at instants distributed like the shutter's transmission, each with its own sample position.
[[nodiscard]] std::vector<ShutterView> shutter_views(const ShutterCurve& curve, const Exposure& exposure,
                                                     int views);

}  // namespace postlens
