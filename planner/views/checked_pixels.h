// Selects the view samples that are compared with rays.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// Selects the view samples that are compared with rays. In each block of pixels, one random pixel is checked
/// to state the error of the image. Another random pixel is checked to decide in which tiles rays replace all
/// view samples.
///
/// A block has 4 x 4 px, and two views of each half are compared in a checked pixel. More views are compared
/// if the radiances of rays are random, because a light has an extent or a material has a lobe. A block then
/// has 5 x 5 px, and a quarter of the views are compared, but at least eight. In small images, blocks are
/// smaller.
///
/// Checking twice as many views in a pixel divides the variance of the result by four, and checking twice as
/// many pixels only by two. More pixels, however, find errors that are rare and large.
///
/// Rays are also aimed at highlights, in the pixel that states the error. The more views the image has, the
/// more of the block's other pixels are used for this, too.
class CheckedPixels {
  public:
    enum class Use : std::uint8_t { none, deciding, stating };
    /// Size of the image, in px. `random_rays` is true if rays have random radiances, for example because a
    /// light has an extent.
    CheckedPixels(int width, int height, bool random_rays);
    [[nodiscard]] Use use(int x, int y) const;
    /// Appends the views that are compared with a ray in pixel (x, y), selected from the views [first, first
    /// + count) of a set. The appended indices are relative to `first`.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;
    /// Implements PatchViews::aimed for a half that has `views` views.
    [[nodiscard]] double aimed(int x, int y, int views) const;

  private:
    struct Place {
        std::uint64_t hash;  ///< hash of the block
        std::uint64_t place,
            stating;  ///< indices in the block of this pixel and of the pixel that states the error
    };
    [[nodiscard]] Place place_of(int x, int y) const;
    /// Number of pixels of a block.
    [[nodiscard]] std::uint64_t pixels() const {
        return static_cast<std::uint64_t>(edge_) * static_cast<std::uint64_t>(edge_);
    }
    int edge_;
    bool random_rays_;
};

}  // namespace postlens
