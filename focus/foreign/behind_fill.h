// Estimates the data that a flat image lacks: the surfaces behind its edges, and empty space that the lens
// disoccludes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "focus/responses/node_response.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// The pixels whose content is known: those that are stored, and all others of the raster, which are empty
/// space.
[[nodiscard]] inline RasterWindow known_pixels(const ForeignPicture& p) {
    return {std::min(0, p.x_begin), std::max(p.width, p.x_end), std::min(0, p.y_begin),
            std::max(p.height, p.y_end)};
}

/// Estimate of the surface behind an opaque pixel. `known` is false if no farther surface is near enough to
/// become visible beside the pixel's edges.
struct Behind {
    float inverse_z = 0, spread_inverse_z = 0;  ///< as those of StackSample
    float r = 0, g = 0, b = 0;                  ///< premultiplied
    float alpha = 0;                            ///< coverage by the surface
    float weight = 0;      ///< share of the pixel that it fills, translucent or not; the rest is empty space
    std::uint32_t id = 0;  ///< as StackSample::id
    bool holdout = false;  ///< as StackSample::holdout
    bool known = false;
    bool fills = false;  ///< the pixel is translucent; only empty space behind it and its neighbours
};

/// Estimates the surface behind stored pixels. From an opaque pixel, eight directions are searched for a
/// farther surface. A surface is farther if its own depth is, and if the signed CoC radius of its own depth
/// or of its blur (StackSample::moved_inverse_z) differs by at least a pixel. It must lie within the sum of
/// both blurs' CoC radii plus a pixel. If samples have ids, only the id with the largest sum of 1 / squared
/// distance counts.
///
/// The depths and the id are those of the nearest of the farther surfaces. The colour is a mean, weighted by
/// 1 / squared distance, of the surfaces that are neither farther nor nearer than that one. Empty space
/// counts as farther than all surfaces and is not blurred. A translucent pixel is treated like an opaque one
/// if there is only empty space behind it in every direction (`fills`).
class BehindSearch {
  public:
    /// Both arguments must outlive the search. `aberration_px`: how much farther spherical aberration moves
    /// light than the CoC radius.
    BehindSearch(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px = 0);
    /// The estimates behind the stored pixels of row `y` of the picture. Several threads may call it.
    void row(int y, std::vector<Behind>& out) const;

  private:
    class Impl;
    std::shared_ptr<const Impl> impl_;
};

/// The estimates behind all stored pixels, row by row.
[[nodiscard]] std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry,
                                              double aberration_px = 0);

/// Computes, for each pixel of a window, row by row, an upper bound of the share of the pixel that shows
/// empty space after blurring. A bound of 1 or more means the whole pixel.
///
/// For a pixel with samples, the bound is the area of the empty pixels within the bounding square of the
/// pixel's CoC, divided by the area of the CoC. It therefore holds for every shape of an edge within the CoC.
/// For an empty pixel the bound is 1. A translucent sample counts as covering its pixel.
/// `aberration_px`: as for behind_fill.
[[nodiscard]] std::vector<float> nothing_in_reach(const ForeignPicture& picture,
                                                  const FocusGeometry& geometry, const RasterWindow& window,
                                                  double aberration_px = 0);

}  // namespace postlens
