// A contact sheet is one image that shows many images as thumbnails with captions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pictures/encoded_picture.h"
#include "pictures/image.h"

namespace postlens {

/// A contact sheet. Its images can be added in any order. The cell of an image that has not been added is
/// dark grey.
class ContactSheet {
  public:
    static constexpr std::size_t most_pictures = 1024;

    /// `captions` holds one ASCII caption per image, for 1 to `most_pictures` images. `columns` is the
    /// requested number of columns. If this number would give a single row, a single column, or thumbnails
    /// that are too small to see, the sheet is made roughly square.
    ContactSheet(ImageSize picture, std::vector<std::string> captions, std::size_t columns);

    void set(std::size_t i, const Image& picture);
    [[nodiscard]] EncodedPicture picture() const;

    [[nodiscard]] std::size_t columns() const { return columns_; }
    /// Returns the size of a thumbnail, in px. A thumbnail is never larger than the image.
    [[nodiscard]] ImageSize thumbnail() const { return {width_, height_}; }

  private:
    std::vector<std::string> captions_;
    std::size_t columns_;
    int width_ = 0, height_ = 0;
    std::vector<EncodedPicture> small_;  ///< thumbnails; empty if not set
};

/// Scales an image down with a box filter. Each pixel becomes the mean of the area that it covers, in
/// scene-linear values. The new width and height must be at least 1 px and at most those of the image.
[[nodiscard]] Image made_smaller(const Image& image, int width, int height);

}  // namespace postlens
