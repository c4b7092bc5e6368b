// Estimates what a lens sees behind an edge: a farther surface or empty space. A flat image does not show it.
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

/// Returns the window that contains the raster (the file's display window) and all pixels that the file
/// stores. The content of all these pixels is known: pixels of the raster that are not stored are empty
/// space.
[[nodiscard]] inline RasterWindow known_pixels(const ForeignPicture& p) {
    return {std::min(0, p.x_begin), std::max(p.width, p.x_end), std::min(0, p.y_begin),
            std::max(p.height, p.y_end)};
}

/// Returns the geometry of the round lens that just contains an aperture. The distance up to which blur
/// reveals surfaces follows from it: a stretched aperture spreads light farther than a CoC radius.
[[nodiscard]] FocusGeometry around_aperture(const FocusGeometry& geometry, const Aperture& aperture);

/// Estimate of the surface behind an opaque pixel. `known` is false if no farther surface is so near that
/// blur can reveal it at this pixel.
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

/// Estimates the surface behind each stored pixel. From an opaque pixel, eight directions are searched for a
/// farther surface.
///
/// A surface counts as farther if its depth is larger and its signed CoC radius differs by at least a pixel.
/// It must also be so near in the image that blur can reveal it. If samples have ids, only one object counts.
/// Each surface has the weight 1 / squared distance, and the object with the largest sum of weights is
/// chosen. Empty space counts as farther than all surfaces and is not blurred.
///
/// The depths and the id come from the nearest of the farther surfaces. The colour is the mean over the
/// surfaces at about the same depth, weighted by 1 / squared distance. A translucent pixel is treated like an
/// opaque one if there is only empty space behind it in every direction (`fills`).
class BehindSearch {
  public:
    /// Both `picture` and `geometry` must outlive the search. `aberration_px` is the distance by which
    /// spherical aberration spreads light beyond the CoC radius.
    BehindSearch(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px = 0);
    /// Sets `out` to the estimated surfaces behind the stored pixels of row `y` of the picture. Several
    /// threads may call this function at the same time.
    void row(int y, std::vector<Behind>& out) const;

  private:
    class Impl;
    std::shared_ptr<const Impl> impl_;
};

/// Returns the estimates behind all stored pixels, row by row.
[[nodiscard]] std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry,
                                              double aberration_px = 0);

/// Returns an upper bound, for each pixel of a window, of the share of the pixel that shows empty space after
/// blurring. The bounds are stored row by row. A bound of 1 or more means the whole pixel.
///
/// For a pixel with samples, the bound compares two areas: the empty pixels in the bounding square of the
/// pixel's CoC, and the CoC itself. The bound is the first area divided by the second. For an empty pixel the
/// bound is 1. A translucent sample counts as covering its pixel. `aberration_px` has the same meaning as in
/// behind_fill.
[[nodiscard]] std::vector<float> nothing_in_reach(const ForeignPicture& picture,
                                                  const FocusGeometry& geometry, const RasterWindow& window,
                                                  double aberration_px = 0);

}  // namespace postlens
