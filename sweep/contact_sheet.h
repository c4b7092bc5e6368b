// A contact sheet: a single image that shows many images as thumbnails with captions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pictures/encoded_picture.h"
#include "pictures/image.h"

namespace postlens {

/// Images are set one by one, in any order. A cell whose image is not set is dark grey.
class ContactSheet {
  public:
    static constexpr std::size_t most_pictures = 1024;

    /// `captions`: ASCII, one per image, 1 to `most_pictures` in number. `columns`: requested number of
    /// columns. If the sheet would have a single row or column, or thumbnails too small to see, it is made
    /// approximately square instead.
    ContactSheet(ImageSize picture, std::vector<std::string> captions, std::size_t columns);

    void set(std::size_t i, const Image& picture);
    [[nodiscard]] EncodedPicture picture() const;

    [[nodiscard]] std::size_t columns() const { return columns_; }
    /// Size of a thumbnail, px. It is at most that of the image.
    [[nodiscard]] ImageSize thumbnail() const { return {width_, height_}; }

  private:
    std::vector<std::string> captions_;
    std::size_t columns_;
    int width_ = 0, height_ = 0;
    std::vector<EncodedPicture> small_;  ///< thumbnails; empty if not set
};

/// Scales an image down with a box filter, in scene-linear values: each pixel is the mean of the area that it
/// covers. The new size must be between 1 px and the size of the image.
[[nodiscard]] Image made_smaller(const Image& image, int width, int height);

}  // namespace postlens
