// Crops or zooms an image about its centre, to the framing of another film distance.
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// Returns the traced pixels that an image of width x height pixels needs if it is magnified by `zoom` about
/// its centre. For zoom < 1 they extend beyond the image.
[[nodiscard]] RasterWindow window_for_zoom(int width, int height, double zoom);

/// Resamples `traced`, which has the pixels of `window`, to width x height pixels. Pixel p shows the position
/// centre + (p - centre) / zoom. A box filter is used: an output pixel is the mean of the traced pixels that
/// it covers, weighted by area. Uniform areas stay uniform, energy is conserved, and zoom = 1 is the
/// identity.
[[nodiscard]] Image reframe(const Image& traced, const RasterWindow& window, int width, int height,
                            double zoom);

}  // namespace postlens
