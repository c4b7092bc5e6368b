// Estimates of what a flat image does not contain: surfaces behind its edges, and disoccluded empty space.
#pragma once

#include <vector>

#include "focus/responses/node_response.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Estimate of the surface behind an opaque pixel. `known` is false if no farther surface is close enough to
/// be disoccluded.
struct Behind {
    float inverse_z = 0;
    float r = 0, g = 0, b = 0;  ///< premultiplied
    float alpha = 0;            ///< the rest is empty
    bool known = false;
    bool fills = false;  ///< the pixel is translucent and only empty space lies behind it and its neighbours
};

/// Estimates the surface behind every stored pixel, row by row. From an opaque pixel, eight directions are
/// searched for a farther surface: an increase of signed CoC radius by at least a pixel, at a distance of at
/// most the sum of both CoC radii plus a pixel. If samples have ids, only the id with the largest sum of 1 /
/// squared distance counts.
///
/// The nearest of the farther surfaces gives the depth. The colour is the mean of the surfaces found whose
/// CoC radius differs from that of the nearest by less than a pixel, weighted by 1 / squared distance. Empty
/// space counts as farther than all surfaces, and is not blurred. A translucent pixel is treated like an
/// opaque one if only empty space was found behind it in every direction (`fills`). The result does not
/// depend on the number of threads.
[[nodiscard]] std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry);

/// For each pixel of a window, row by row: upper bound of the share of the pixel that shows empty space after
/// blurring; 1 or more means all of the pixel. For a pixel with samples, the bound is the area of the empty
/// pixels within the bounding square of the pixel's CoC, divided by the area of the CoC. It thus holds for
/// every shape of an edge within the CoC. For an empty pixel the bound is 1. A translucent sample counts as
/// covering its pixel.
[[nodiscard]] std::vector<float> nothing_in_reach(const ForeignPicture& picture,
                                                  const FocusGeometry& geometry, const RasterWindow& window);

}  // namespace postlens
