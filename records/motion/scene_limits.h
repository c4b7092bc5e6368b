// Limits of the numbers in a scene.
#pragma once

namespace postlens {

/// Largest length in a scene, in metres. Its square is far below the largest float.
inline constexpr double largest_length_m = 1e12;
/// Smallest extent of a shape, in metres.
inline constexpr double smallest_extent_m = 1e-12;
/// Largest colour, intensity or coefficient in a scene.
inline constexpr double largest_colour = 1e12;
/// Largest width and height of a camera's raster, in px.
inline constexpr int largest_raster_px = 1 << 16;

}  // namespace postlens
