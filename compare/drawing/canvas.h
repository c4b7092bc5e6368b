// An 8-bit sRGB image on which OpenCV draws images, rectangles and text.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "pictures/encoded_picture.h"
#include "pictures/image.h"

namespace postlens {

using Rgb8 = std::array<std::uint8_t, 3>;

/// Background colour behind the images and texts of a comparison.
inline constexpr Rgb8 dark_background{24, 24, 24};
/// Minimum width, in px, of an image with a legend, so that the text fits.
inline constexpr int least_legend_width_px = 440;
/// Distance between lines of text, and margin around it, in px at scale 1.
inline constexpr int text_line_px = 18, text_margin_px = 10;

class Canvas {
  public:
    Canvas(int width, int height, Rgb8 background);
    /// Fills a rectangle, clipped at the border of the canvas.
    void fill(int x, int y, int width, int height, Rgb8 colour);
    void dot(int x, int y, Rgb8 colour);
    /// Copies an image to the canvas, with its top left corner at (x, y). The image must lie within the
    /// canvas.
    void picture(int x, int y, const EncodedPicture& picture);
    /// Writes ASCII text in white. Its baseline begins at (x, y). Capitals are 9 px high at `scale` 1.
    void text(int x, int y, double scale, const std::string& words);
    [[nodiscard]] static int text_width(double scale, const std::string& words);
    /// Returns the canvas, which stores 8-bit sRGB values, as an image of scene-linear values. If
    /// `write_image` writes this image as 8-bit sRGB, the file has exactly the values of the canvas.
    [[nodiscard]] Image image() const;
    [[nodiscard]] EncodedPicture encoded() const;

  private:
    cv::Mat pixels_;  // CV_8UC3, with the channels in the order red, green, blue
};

}  // namespace postlens
