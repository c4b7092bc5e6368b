// How many views a light field over the shutter's time takes, and where in the pixel each of them looks.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"

namespace postlens {

/// As many places in the pixel; what stands still is drawn once for each.
inline constexpr int most_places = 64;
inline constexpr int fewest_views = 128;  ///< unless the user asks for fewer
inline constexpr int most_views_by_itself = 512;
inline constexpr int most_views = 4096;  ///< that a user may ask for

/// Throws Error(wrong_arguments) for a number outside 1..most_views.
void check_views(const std::optional<int>& views);

/// Place j of `places`, a power of 2, px: a (0, 2)-sequence in base 2 [sobol1967], every aligned run of 2^k
/// of which has one place in every cell of every grid of 2^k equal cells, so that views close in time lie far
/// apart in the pixel.
[[nodiscard]] glm::dvec2 place_in_pixel(std::uint32_t j, double places);

/// A view for every two pixels of the longest way; a power of 2 from `fewest_views` to
/// `most_views_by_itself`. Against 2048 views, 128 err by 51 dB on a box that goes 128 px, 256 by 59 dB on a
/// wheel of 467 px that rolls (docs/motion.md).
[[nodiscard]] int views_for_way(double longest_px);

struct ShutterView {
    glm::dvec2 place{0.5, 0.5};  ///< in the pixel, px
    double time_s = 0;
};
/// Instants as frequent as the shutter lets light through, each with its place in the pixel.
[[nodiscard]] std::vector<ShutterView> shutter_views(const ShutterCurve& curve, const Exposure& exposure,
                                                     int views);

}  // namespace postlens
