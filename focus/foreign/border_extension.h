// Estimates what lies beyond the border of another program's image, because blur spreads it into the image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "focus/responses/node_response.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Continues the samples of the outermost pixels beyond the border of the image. On average, the border cuts
/// a surface in the middle. A sample is therefore continued outwards as far as its surface extends into the
/// image, but not farther than its circle of confusion reaches. Its colour and alpha are means over this part
/// of the surface.
///
/// Samples of neighbouring pixels belong to one surface if are_one_surface returns true. Pixels of the raster
/// that are not stored are empty space, so nothing is continued into them.
class BorderExtension {
  public:
    /// `aberration_px` is the distance by which spherical aberration spreads light beyond the CoC radius.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// The window that contains the raster, the stored pixels and the pixels into which samples continue.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// Sets `stack` to the samples that continue into a pixel outside both the raster and the stored pixels.
    /// Returns the index of the stored pixel from which these samples continue. Returns nothing if no sample
    /// continues there.
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample of an outermost pixel, with the mean colour and alpha of its continuation.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The samples of each pixel along one side, nearest first. It is empty if the raster continues beyond
    /// that side of the stored pixels.
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
