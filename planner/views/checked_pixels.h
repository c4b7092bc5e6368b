// Selects the view samples that are compared with rays.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// Selects the view samples that are compared with rays. Two random pixels of each block of pixels are
/// checked. One states the error of the image, the other decides in which tiles rays replace all view
/// samples.
///
/// A block has 4 x 4 px (2 x 2 px in small images), and two views of each half are compared in a checked
/// pixel. If rays have random radiances, the block is 1 px wider, and a quarter of the views are compared, at
/// least eight.
class CheckedPixels {
  public:
    enum class Use : std::uint8_t { none, deciding, stating };
    /// Size of the image, in px. `random_rays` states whether rays have random radiances, for example because
    /// a light has an extent.
    CheckedPixels(int width, int height, bool random_rays);
    [[nodiscard]] Use use(int x, int y) const;
    /// Appends those of the views [first, first + count) of a set that are compared with a ray in pixel (x,
    /// y). The appended indices are relative to `first`.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;
    /// Implements PatchViews::aimed for a half that has `views` views. The more views, the more pixels of a
    /// block get rays that are aimed at highlights.
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
