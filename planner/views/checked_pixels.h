// Selects the samples of views that are compared with rays.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// Selects the samples of views that are compared with rays. In each block of pixels, one random pixel is
/// checked to state the image's error. Another random pixel is checked to decide in which tiles rays replace
/// all samples.
///
/// The radiances of rays are random if a light has an extent or a material has a lobe. In this case, a
/// quarter of the views of each half, but at least eight, are compared in one pixel of each 5 x 5 px (3 x 3
/// px in small images). Otherwise two views are compared in one pixel of each 4 x 4 px (2 x 2 px). Twice as
/// many views divide the variance of the product of two noisy means by four. Twice as many pixels would
/// divide it only by two, but would find errors that are rare and large. The noise of an image's views
/// decreases with their number, so the error of the records must be known better the more views there are.
///
/// Rays are aimed at the highlights of the pixel that states the error. The more views the image has, the
/// more other pixels of the block are treated in the same way. Errors of highlights are rare and large, and
/// their rays cost little compared with many views.
class CheckedPixels {
  public:
    enum class Use : std::uint8_t { none, deciding, stating };
    /// `width`, `height`: size of the image, px. `random_rays`: whether the radiances of rays are random.
    CheckedPixels(int width, int height, bool random_rays);
    [[nodiscard]] Use use(int x, int y) const;
    /// Appends the indices of the checked views among views [first, first + count) of a set. The indices are
    /// relative to `first`: 0 to count - 1.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;
    /// PatchViews::aimed, for a half that has `views` views.
    [[nodiscard]] double aimed(int x, int y, int views) const;

  private:
    struct Place {
        std::uint64_t hash;  ///< hash of the block
        std::uint64_t place,
            stating;  ///< indices in the block: of this pixel, and of the one that states the error
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
