// Estimates which surface, or empty space, a lens sees behind an edge. An image of a pinhole does not show
// it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "focus/responses/node_response.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Returns the smallest rectangle that contains the file's display window and all stored pixels. Pixels of
/// the display window that are not stored are empty space.
[[nodiscard]] inline RasterWindow known_pixels(const ForeignPicture& p) {
    return {std::min(0, p.x_begin), std::max(p.width, p.x_end), std::min(0, p.y_begin),
            std::max(p.height, p.y_end)};
}

/// Returns `geometry` with a larger aperture radius: that of the smallest circle, centred on the lens, around
/// the given aperture. A stretched aperture spreads light farther than the CoC radius, and so may reveal more
/// hidden surfaces.
[[nodiscard]] FocusGeometry around_aperture(const FocusGeometry& geometry, const Aperture& aperture);

/// Estimate of the surface behind an opaque pixel.
struct Behind {
    float inverse_z = 0, spread_inverse_z = 0;  ///< same meaning as in StackSample
    float r = 0, g = 0, b = 0;                  ///< premultiplied
    float alpha = 0;                            ///< coverage by the surface
    float weight = 0;      ///< share of the pixel that the surface fills; the rest is empty space
    std::uint32_t id = 0;  ///< as StackSample::id
    bool holdout = false;  ///< as StackSample::holdout
    bool known = false;
    bool fills = false;  ///< the pixel is translucent, with only empty space behind it and its neighbours
};

/// Estimates which surface lies behind the visible surface of each stored pixel. This is needed because a
/// lens may see past an edge, but the image shows nothing behind it. The search goes in eight directions to
/// the nearest farther surface whose blur reaches the pixel. Empty space counts as the farthest surface.
///
/// The colour is the mean of the samples found, weighted by 1 / squared distance. If samples have ids, only
/// the object with the largest sum of weights counts.
class BehindSearch {
  public:
    /// Prepares the search for hidden surfaces behind the pixels of `picture`, as the lens in `geometry` may
    /// see them. `picture` and `geometry` must outlive this object. `aberration_px` is the distance, in px,
    /// by which spherical aberration spreads light beyond the circle of confusion.
    BehindSearch(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px = 0);
    /// Estimates, for each pixel of row `y`, the surface that lies behind the visible one. Writes the
    /// estimates to `out`, one per pixel. Several threads may call this function at the same time.
    void row(int y, std::vector<Behind>& out) const;

  private:
    class Impl;
    std::shared_ptr<const Impl> impl_;
};

/// Returns the estimates behind all stored pixels, row by row.
[[nodiscard]] std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry,
                                              double aberration_px = 0);

/// Returns, for each pixel of `window`, an upper bound of the fraction of the pixel that empty space (pixels
/// without any surface) fills in the blurred image. The bound is not tight, and may exceed 1. The values are
/// ordered row by row.
[[nodiscard]] std::vector<float> nothing_in_reach(const ForeignPicture& picture,
                                                  const FocusGeometry& geometry, const RasterWindow& window,
                                                  double aberration_px = 0);

}  // namespace postlens
