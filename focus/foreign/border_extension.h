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
/// A surface is extended by n pixels: as far as it reaches from the border into the image, but at most by its
/// blur radius. Its colour and alpha outside are the means of its n pixels at the border.
class BorderExtension {
  public:
    /// `aberration_px` is the distance by which spherical aberration spreads light beyond the CoC radius.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// Returns the rectangle of pixels that contains the image and the surfaces extended beyond the image
    /// border.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// The pixel (x, y) lies outside the image. Sets `stack` to the samples that this pixel gets from
    /// surfaces extended beyond the image border. Returns the index of the pixel at the border from which
    /// these surfaces are extended, or nothing if no surface reaches (x, y).
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample of a pixel at the image border, with the distance `length_px` by which it is extended
    /// outwards. Its surface covers as many pixels inwards from the border, or more. The colour and alpha of
    /// `sample` are the means over these `length_px` pixels.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The samples along one side of the image, extended outwards beyond the border. There is one list for
    /// each pixel of this side, with all samples of the pixel, one behind another. A list is empty if the
    /// pixel has no samples, because the file shows empty space there.
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
