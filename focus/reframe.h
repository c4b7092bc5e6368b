// Magnifies or shrinks an image about its centre, so that it shows what a film at another distance from the
// lens would show.
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// Returns the traced pixels that are needed for an image of width x height pixels, magnified by `zoom` about
/// its centre. For zoom < 1, they extend beyond the image.
[[nodiscard]] RasterWindow window_for_zoom(int width, int height, double zoom);

/// Magnifies `traced`, an image of the raster area `window`, by the factor `zoom` about the centre of the
/// image. Returns `width` x `height` pixels. Each is the mean of the traced pixels that it covers, weighted
/// by area.
[[nodiscard]] Image reframe(const Image& traced, const RasterWindow& window, int width, int height,
                            double zoom);

}  // namespace postlens
