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

/// Extends surfaces beyond the image border, because the blur of what lies outside may reach into the image.
/// A surface is extended by as many pixels as it reaches from the border into the image, but at most by its
/// blur radius.
class BorderExtension {
  public:
    /// Surfaces must be extended as far as their blur reaches. This is the CoC radius plus `aberration_px`,
    /// the distance, in px, by which spherical aberration spreads light beyond this radius.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// Returns the rectangle of pixels that contains the image and the surfaces extended beyond the image
    /// border.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// Returns in `stack` what a pixel (x, y) outside the image contains: a sample of each surface that is
    /// extended from the image border to this pixel. Returns the index of the border pixel from which these
    /// surfaces are extended, or nothing if none reaches (x, y).
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample at the image border, from which its surface is extended outwards by `length_px` pixels. The
    /// colour and alpha of `sample` are the means over the surface's first `length_px` pixels from the border
    /// inwards.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The samples along one side of the image, from which surfaces are extended beyond the border. There is
    /// one list for each pixel of this side, with all samples of the pixel. The list is empty if the file
    /// shows only empty space in the pixel.
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
