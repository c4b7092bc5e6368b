// Estimates the surfaces beyond the border of another program's image, because their blur reaches into the
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

/// Continues the surfaces of an image beyond its border, as far outwards as inwards, but not farther than
/// their blur. Colour and alpha are means over the inner part.
class BorderExtension {
  public:
    /// `aberration_px` is the distance by which spherical aberration spreads light beyond the CoC radius.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// The window that contains the raster, the stored pixels and all continued samples.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// Sets `stack` to the samples that are continued into the pixel (x, y), outside all known pixels.
    /// Returns the index of their stored pixel, if any.
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample at the border, and the distance to which it is continued. Its colour and alpha are means over
    /// its surface.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The samples of each pixel along one side, nearest first. The list is empty if the raster, which is
    /// empty space there, extends beyond the stored pixels.
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
