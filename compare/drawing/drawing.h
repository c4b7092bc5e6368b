// Drawings of optics and curves. They consist of lines, areas and text, and are written as SVG or as an
// image.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// A figure on a white background. Coordinates are in px from its top left corner, with y down. Each call
/// draws over the earlier ones.
class Drawing {
  public:
    using Colour = std::array<std::uint8_t, 3>;
    struct Point {
        double x = 0, y = 0;
    };
    enum class Anchor { start, middle, end };

    /// Width and height are 1 to 16384 px.
    Drawing(int width_px, int height_px) : width_(width_px), height_(height_px) {}

    void line(std::vector<Point> points, Colour colour, double width_px = 1, bool dashed = false);
    /// Draws a filled and outlined polygon of 3 points or more.
    void area(std::vector<Point> points, Colour fill, Colour edge, double width_px = 1);
    void dot(Point at, double radius_px, Colour colour);
    /// Writes ASCII text whose baseline begins, ends or is centred at `at`. `size_px` is 1.4 times the height
    /// of the capitals.
    void text(Point at, double size_px, const std::string& words, Anchor anchor = Anchor::start);

    [[nodiscard]] std::string svg() const;
    /// Scene-linear, for `write_image`.
    [[nodiscard]] Image image() const;

  private:
    enum class Kind { line, area, dot, text };
    struct Part {
        Kind kind = Kind::line;
        std::vector<Point> points;
        Colour fill{}, edge{};
        double size = 1;
        bool dashed = false;
        std::string words;
        Anchor anchor = Anchor::start;
    };
    int width_, height_;
    std::vector<Part> parts_;
};

/// Throws Error(wrong_arguments) unless the file name ends in .svg or in a suffix that `write_image`
/// supports. `others` lists further suffixes for the error message.
void check_drawing_path(const std::filesystem::path& path, const char* others = "");

/// Writes the drawing in the format that the suffix of the file name selects. Throws Error(cannot_write).
void write_drawing(const std::filesystem::path& path, const Drawing& drawing);

}  // namespace postlens
