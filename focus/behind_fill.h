// Guesses: what stands behind the edges of a picture that only has what is in front, and where nothing comes
// to light.
#pragma once

#include <vector>

#include "focus/node_response.h"
#include "lens/focus_geometry.h"
#include "records/foreign_picture.h"

namespace postlens {

/// A guess of what an opaque pixel hides; `known` is false where nothing farther is near enough to come to
/// light.
struct Behind {
    float inverse_z = 0;
    float r = 0, g = 0, b = 0;  ///< premultiplied
    float alpha = 0;            ///< the rest is nothing
    bool known = false;
    bool fills = false;  ///< what is seen through the pixel's last sample is nothing, here and around
};

/// For each pixel stored, row by row. From an opaque pixel the picture is searched in eight directions, as
/// far as the circles of both reach, for where something farther begins: a step of a pixel or more of signed
/// radius. Where samples have ids, only the finds of the id count that has the greatest sum of one over the
/// squared distances. The nearest find gives the depth; finds of the same depth (within a pixel of radius)
/// are averaged by one over their squared distances. Nothing counts as farther than all, and spreads by no
/// circle. A pixel that lets through is searched from like an opaque one where no direction shows, so far,
/// the begin of anything farther but nothing (`fills`). The same for any number of threads.
[[nodiscard]] std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry);

/// For each pixel of a window, row by row: how much of it nothing may come to fill once all is spread. Where
/// something stands, what is nothing in the square around its own circle, in circles: all of it where the
/// circle sees an edge before nothing, however that runs. Elsewhere what of the pixel is nothing. What lets
/// through stands in all of its pixel.
[[nodiscard]] std::vector<float> nothing_in_reach(const ForeignPicture& picture,
                                                  const FocusGeometry& geometry, const RasterWindow& window);

}  // namespace postlens
