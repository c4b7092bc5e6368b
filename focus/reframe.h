// A picture cropped or zoomed about its centre, as another film distance would have framed it.
#pragma once

#include "focus/splat_tables.h"
#include "records/image.h"

namespace postlens {

/// The traced pixels that a picture of width x height needs when its centre is magnified by `zoom`: more than
/// the picture itself where zoom < 1.
[[nodiscard]] RasterWindow window_for_zoom(int width, int height, double zoom);

/// The picture of width x height whose pixel p shows what lies at centre + (p - centre) / zoom of `traced`,
/// which holds the pixels of `window`. Every traced pixel counts as an even square: an output pixel is the
/// mean over the box that it covers, so that even areas stay even, energy is kept, and zoom = 1 changes
/// nothing.
[[nodiscard]] Image reframe(const Image& traced, const RasterWindow& window, int width, int height,
                            double zoom);

}  // namespace postlens
