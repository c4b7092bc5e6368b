// Selects the view samples that are compared with rays.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// Selects the pixels and views (images from different lens points) whose recorded colours are compared with
/// rays, to measure the error. In each block of pixels, two random pixels are checked. One states the error
/// of the image, the other decides in which tiles rays replace all recorded colours.
///
/// A block has 4 x 4 px, 2 x 2 px in small images, and 2 x 1 px in the smallest. In a checked pixel, two
/// views of each half are compared. If rays have random radiances, a quarter of the views are compared, at
/// least four.
class CheckedPixels {
  public:
    enum class Use : std::uint8_t { none, deciding, stating };
    /// Divides an image of `width` x `height` px into blocks, in each of which two pixels are checked by
    /// rays.
    /// - `random_rays`: whether the radiances of rays are noisy, for example because of area lights. Then
    ///   more views (images from different lens points) are checked in each of these pixels, so that the
    ///   noise averages out.
    CheckedPixels(int width, int height, bool random_rays);
    [[nodiscard]] Use use(int x, int y) const;
    /// Chooses the views (images from single lens points) in which a ray checks the colour of pixel (x, y).
    /// They are chosen among `count` views, whose lens points are the point number `first` of the sequence
    /// number `set` and those after it. Appends the indices of the chosen views to `out`; index 0 is the
    /// point number `first`. Appends nothing if the pixel is not checked.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;
    /// The error of the highlights is measured in some randomly chosen pixels, by rays that are aimed at the
    /// highlights. Returns the probability with which pixel (x, y) was chosen, or 0 if it was not chosen. The
    /// probability is larger for an image with more views: `views` is their number.
    [[nodiscard]] double aimed(int x, int y, int views) const;

  private:
    struct Place {
        std::uint64_t hash;  ///< hash of the block
        std::uint64_t place,
            stating;  ///< indices in the block of this pixel and of the pixel that states the error
    };
    [[nodiscard]] Place place_of(int x, int y) const;
    /// Number of pixels in a block, of which two are checked.
    [[nodiscard]] std::uint64_t pixels() const {
        return static_cast<std::uint64_t>(columns_) * static_cast<std::uint64_t>(rows_);
    }
    int columns_, rows_;  ///< size of a block, in px
    bool random_rays_;
};

}  // namespace postlens
