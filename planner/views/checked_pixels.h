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
    /// Divides an image of `width` x `height` px into blocks. In each block, rays check the recorded colours
    /// of two pixels.
    /// - `random_rays`: whether the radiance of a ray is noisy, for example because of area lights. Then more
    ///   rays are traced per pixel, so that the noise averages out.
    CheckedPixels(int width, int height, bool random_rays);
    [[nodiscard]] Use use(int x, int y) const;
    /// Chooses some of the views of pixel (x, y). A view is an image from one lens point. In each chosen
    /// view, a ray checks the recorded colour of the pixel. The views form two halves, and each view has a
    /// number in its half.
    /// - `set`: number of the half, 0 or 1
    /// - `first`, `count`: the views to choose from have the numbers `first` to `first` + `count` - 1
    /// - `out`: receives the indices of the chosen views, from 0 to `count` - 1, after its present elements.
    ///   Receives nothing if the pixel is not checked.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;
    /// Returns the probability with which pixel (x, y) was chosen at random, or 0 if it was not chosen. In
    /// chosen pixels, rays measure the error of the highlights (bright spots that the lens blurs). The
    /// probability increases with `views`, the number of averaged images from single lens points.
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
