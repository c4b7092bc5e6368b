// A contact sheet: one image of many thumbnails with captions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pictures/encoded_picture.h"
#include "pictures/image.h"

namespace postlens {

/// A contact sheet: thumbnails of a sweep's images in one image. They can be added in any order; missing ones
/// are dark grey.
class ContactSheet {
  public:
    static constexpr std::size_t most_pictures = 1024;

    /// Creates an empty contact sheet. `captions` contains the ASCII text below each image, so it has 1 to
    /// `most_pictures` elements. `columns` is the requested number of images per row. If it leads to a single
    /// row, a single column or tiny thumbnails, the sheet is roughly square instead.
    ContactSheet(ImageSize picture, std::vector<std::string> captions, std::size_t columns);

    void set(std::size_t i, const Image& picture);
    [[nodiscard]] EncodedPicture picture() const;

    [[nodiscard]] std::size_t columns() const { return columns_; }
    [[nodiscard]] ImageSize thumbnail() const { return {width_, height_}; }

  private:
    std::vector<std::string> captions_;
    std::size_t columns_;
    int width_ = 0, height_ = 0;
    std::vector<EncodedPicture> small_;  ///< thumbnails; empty if not set
};

/// Scales an image down with a box filter: each pixel is the mean of its area, in scene-linear values. The
/// new size must be at least 1 px, and at most the old one.
[[nodiscard]] Image made_smaller(const Image& image, int width, int height);

}  // namespace postlens
