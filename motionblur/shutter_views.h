// Determines how many views a light field has over the exposure, and the instant and sample position of each
// view.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"

namespace postlens {

/// Largest number of different sample positions in a pixel. Static surfaces are drawn once for each of them.
inline constexpr int most_places = 64;

/// Automatic numbers of views. They are prime: if a motion repeats k times during the exposure, the views
/// show it at M / gcd(M, k) different phases, so 512 views of 64 turns would show only 8 positions.
inline constexpr std::array automatic_views{131, 257, 521};
inline constexpr int most_views = 4096;  ///< largest number of views that a user may set

/// Throws Error(wrong_arguments) for a number outside 1..most_views.
void check_views(const std::optional<int>& views);

/// Returns element j of a (0, 2)-sequence in base 2 [sobol1967] as a sample position in the pixel, in px.
/// `places` is the number of different positions, a power of 2. Successive positions are far apart, so views
/// that are close in time have very different positions.
[[nodiscard]] glm::dvec2 place_in_pixel(std::uint32_t j, double places);

/// Returns the automatic number of views for objects that move by up to `longest_px`: the smallest of
/// `automatic_views` that has one view per 2 px, or the largest. docs/motion.md states the resulting error.
[[nodiscard]] int views_for_way(double longest_px);

struct ShutterView {
    glm::dvec2 place{0.5, 0.5};  ///< sample position in the pixel, px
    double time_s = 0;
};
/// Returns views at instants that are distributed like the shutter's transmission. Each view has its own
/// sample position in the pixel.
[[nodiscard]] std::vector<ShutterView> shutter_views(const ShutterCurve& curve, const Exposure& exposure,
                                                     int views);

}  // namespace postlens
