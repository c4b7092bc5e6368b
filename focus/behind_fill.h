// Estimates of what a flat image does not contain: surfaces behind its edges, and disoccluded empty space.
#pragma once

#include <vector>

#include "focus/node_response.h"
#include "lens/focus_geometry.h"
#include "records/foreign_picture.h"

namespace postlens {

/// Estimate of the surface behind an opaque pixel. `known` is false if no farther surface is close enough to
/// be disoccluded.
struct Behind {
    float inverse_z = 0;
    float r = 0, g = 0, b = 0;  ///< premultiplied
    float alpha = 0;            ///< the rest is empty
    bool known = false;
    bool fills = false;  ///< StackLights::add: only empty space is behind the pixel and its neighbours
};

/// One estimate per stored pixel, row by row. From an opaque pixel, searches eight directions for a farther
/// surface: an increase of signed CoC radius by at least a pixel, at a distance that the circles of both can
/// bridge. If samples have ids, only the id with the largest sum of 1 / squared distance counts. The nearest
/// find gives the depth; the colour is the mean of the finds within a pixel of CoC radius, weighted by 1 /
/// squared distance. Empty space counts as farther than all surfaces, and is not blurred. Translucent pixels
/// are treated like opaque ones if only empty space was found behind them in every direction (`fills`). Same
/// result for any number of threads.
[[nodiscard]] std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry);

/// For each pixel of a window, row by row: how much of it nothing may come to fill once all is spread. Where
/// something stands, what is nothing in the square around its own circle, in circles: all of it where the
/// circle sees an edge before nothing, however that runs. Elsewhere what of the pixel is nothing. What lets
/// through stands in all of its pixel.
[[nodiscard]] std::vector<float> nothing_in_reach(const ForeignPicture& picture,
                                                  const FocusGeometry& geometry, const RasterWindow& window);

}  // namespace postlens
