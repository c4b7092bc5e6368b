// An 8-bit sRGB picture to draw on with OpenCV. Used by cause_picture.cpp, error_map.cpp, side_by_side.cpp
// and sweep/contact_sheet.cpp only.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "records/encoded_picture.h"
#include "records/image.h"

namespace postlens {

using Rgb8 = std::array<std::uint8_t, 3>;

class Canvas {
  public:
    Canvas(int width, int height, Rgb8 background);
    /// Parts beyond the border are cut off.
    void fill(int x, int y, int width, int height, Rgb8 colour);
    void dot(int x, int y, Rgb8 colour);
    /// One that lies within.
    void picture(int x, int y, const EncodedPicture& picture);
    /// ASCII in white, (x, y) the left end of its base line; `scale` 1 has capitals of 9 px.
    void text(int x, int y, double scale, const std::string& words);
    [[nodiscard]] static int text_width(double scale, const std::string& words);
    /// Scene-linear, for `write_image`, which gives back these very bytes.
    [[nodiscard]] Image image() const;
    [[nodiscard]] EncodedPicture encoded() const;

  private:
    cv::Mat pixels_;  // CV_8UC3 in the order red, green, blue
};

}  // namespace postlens
