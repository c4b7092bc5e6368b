// Estimates what continues beyond the border of another program's image, where blur reaches into the image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "focus/responses/node_response.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// The samples of the image's outermost pixels, continued outwards. A sample continues as far as its surface
/// reaches inwards from the border, because a border cuts a surface of unknown extent in the middle on
/// average, but not farther than its circle of confusion reaches. Its colour and alpha are the means over
/// this length. A surface is one as in Facets: equal ids, or none, and CoC radii that differ by less than a
/// pixel (beyond 16 px: by less than a 16th) from pixel to pixel.
///
/// Pixels of the raster that are not stored are empty space, so nothing continues into them.
class BorderExtension {
  public:
    /// `aberration_px`: how much farther than the CoC radius spherical aberration moves light.
    BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px);

    /// The raster, the stored pixels and those into which samples continue.
    [[nodiscard]] const RasterWindow& window() const { return window_; }
    /// Sets `stack` to the samples that continue in a pixel outside the raster and the stored pixels. Returns
    /// the index of the stored pixel from which they continue, or nothing if there are none.
    [[nodiscard]] std::optional<std::size_t> continued(int x, int y, std::vector<StackSample>& stack) const;

  private:
    /// A sample of an outermost pixel, with the mean colour and alpha of its continuation.
    struct Continued {
        StackSample sample;
        int length_px = 0;
    };
    /// The samples of each pixel along one side, nearest first. Empty if the raster ends beyond that side of
    /// the stored pixels.
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
