// Many pictures as one, each small and with its words below.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "records/encoded_picture.h"
#include "records/image.h"

namespace postlens {

/// Filled picture by picture, in any order; what is missing stays dark.
class ContactSheet {
  public:
    static constexpr std::size_t most_pictures = 1024;

    /// `captions`: ASCII, one a picture, 1 to `most_pictures`. `columns`: as many as a row is to have; where
    /// that is all of them or too many to be seen, rows are wrapped.
    ContactSheet(ImageSize picture, std::vector<std::string> captions, std::size_t columns);

    void set(std::size_t i, const Image& picture);
    [[nodiscard]] EncodedPicture picture() const;

    [[nodiscard]] std::size_t columns() const { return columns_; }
    /// Of each picture on it, px: no larger than the picture itself.
    [[nodiscard]] ImageSize thumbnail() const { return {width_, height_}; }

  private:
    std::vector<std::string> captions_;
    std::size_t columns_;
    int width_ = 0, height_ = 0;
    std::vector<EncodedPicture> small_;  ///< empty: missing
};

/// The mean of what each pixel of the smaller picture covers, in scene-linear light; sizes 1 to the
/// picture's own.
[[nodiscard]] Image made_smaller(const Image& image, int width, int height);

}  // namespace postlens
