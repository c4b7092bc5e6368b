// Drawings of lines, areas and text, written as SVG or as an image.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// A figure on a white background. Coordinates are in px from the top left corner, y down. Later calls draw
/// over earlier ones.
class Drawing {
  public:
    using Colour = std::array<std::uint8_t, 3>;
    struct Point {
        double x = 0, y = 0;
    };
    enum class Anchor { start, middle, end };

    /// The width and the height must be 1 to 16384 px.
    Drawing(int width_px, int height_px) : width_(width_px), height_(height_px) {}

    void line(std::vector<Point> points, Colour colour, double width_px = 1, bool dashed = false);
    /// Draws a filled polygon of at least three points, with an outline.
    void area(std::vector<Point> points, Colour fill, Colour edge, double width_px = 1);
    void dot(Point at, double radius_px, Colour colour);
    /// Writes ASCII text. The point `at` is the beginning, middle or end of the baseline, according to
    /// `anchor`. Capitals are size_px / 1.4 px high.
    void text(Point at, double size_px, const std::string& words, Anchor anchor = Anchor::start);

    [[nodiscard]] std::string svg() const;
    /// Returns the drawing as scene-linear values, for `write_image`.
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

/// Throws Error(wrong_arguments) unless the file name ends in .svg or an image extension. `others` lists
/// further extensions for the message.
void check_drawing_path(const std::filesystem::path& path, const char* others = "");

/// Writes the drawing in the format of the file name's extension. Throws Error(cannot_write).
void write_drawing(const std::filesystem::path& path, const Drawing& drawing);

}  // namespace postlens
