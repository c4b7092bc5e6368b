// Estimates the surfaces beyond the border of an image from another program, because their blur reaches into
// the image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "focus/responses/node_response.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Extends surfaces beyond the image border, because their blur may reach into the image. A surface is
/// extended by n pixels: as far as it reaches into the image, but at most by its blur radius. Its colour and
/// alpha outside are the means of its n pixels at the border.
class BorderExtension {
  public:
    /// `aberration_px` is the distance by which spherical aberration spreads light beyond the CoC radius.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// Returns the rectangle of pixels that contains the image and the surfaces extended beyond the image
    /// border.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// Sets `stack` to the samples of surfaces that are extended from the image to the pixel (x, y) outside.
    /// Returns the index of the border pixel from which they are extended, if any.
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample at the image border, extended by `length_px` pixels beyond the border. The colour of `sample`
    /// is the mean of its surface's `length_px` pixels inside the border.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The extended samples along one side of the image, one list for each pixel of this side. A list is
    /// empty if the file shows empty space there.
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
