// Estimates the surfaces beyond the border of another program's image. Blur spreads their light into the
// image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "focus/responses/node_response.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Continues the surfaces at the border of an image beyond the border. On average, the border cuts a surface
/// in the middle. A sample at the border is therefore continued outwards as far as its surface extends into
/// the image, but not farther than its blur reaches. Its colour and alpha are means over the part of the
/// surface that extends as far into the image.
///
/// Samples of neighbouring pixels belong to one surface if are_one_surface returns true. Pixels of the raster
/// that are not stored are empty space, so nothing is continued into them.
class BorderExtension {
  public:
    /// `aberration_px` is the distance by which spherical aberration spreads light beyond the CoC radius.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// The window that contains the raster, the stored pixels and all pixels into which samples are
    /// continued.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// Sets `stack` to the samples that are continued into the pixel (x, y). The pixel must lie outside both
    /// the raster and the stored pixels. Returns the index of the stored pixel that the samples come from, or
    /// nothing if there are no samples.
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample of an outermost pixel, with the mean colour and alpha of its surface near the border, and the
    /// distance to which it is continued.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The samples of each pixel along one side, nearest first. The list is empty if the raster extends
    /// beyond the stored pixels on this side: pixels of the raster that are not stored are empty space.
    using Side = std::vector<std::vector<Continued>>;

    [[nodiscard]] Side side(int x, int y, int along_x, int along_y) const;
    [[nodiscard]] Continued continue_inwards(const StackSample& sample, int x, int y, int dx, int dy) const;
    [[nodiscard]] const StackSample* next_of(const StackSample& sample, int x, int y) const;

    const ForeignPicture& p_;
    FocusGeometry geometry_;
    double aberration_px_;
    RasterWindow window_;
    Side left_, right_, top_, bottom_;
};

}  // namespace postlens
