// Magnifies or shrinks an image about its centre, so that it shows what a film at another distance from the
// lens would show.
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// Returns which traced pixels are needed to magnify an image of width x height pixels by `zoom` about its
/// centre. For zoom > 1, they are only the middle of the image. For zoom < 1, the image shrinks, so traced
/// pixels around it are needed, too.
[[nodiscard]] RasterWindow window_for_zoom(int width, int height, double zoom);

/// Magnifies `traced`, an image of the raster area `window`, by the factor `zoom` about the image's centre.
/// Returns an image of `width` x `height` pixels. Each of its pixels is the mean of the traced pixels that it
/// covers, weighted by the covered area.
[[nodiscard]] Image reframe(const Image& traced, const RasterWindow& window, int width, int height,
                            double zoom);

}  // namespace postlens
