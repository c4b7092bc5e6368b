#include "compare/drawing/side_by_side.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/drawing/canvas.h"
#include "compare/drawing/error_map.h"

namespace postlens {
namespace {

constexpr int between_px = 8;

// Positions and sizes, in px. The image, the reference and their error map (the panels) are drawn side by
// side, equally wide.
struct Layout {
    double scale = 0;
    int panel, gap, line, width, height, text_top;
    Layout(ImageSize pictures, std::size_t lines) : panel(error_map_size(pictures).width) {
        scale = std::clamp(panel / 1280.0, 1.0, 8.0);
        gap = static_cast<int>(std::lround(between_px * scale));
        line = static_cast<int>(std::lround(text_line_px * scale));
        width = 3 * panel + 4 * gap;
        text_top = line + gap + error_map_size(pictures).height + gap;
        height = text_top + static_cast<int>(lines) * line + gap;
    }
};

}  // namespace

Image side_by_side(const Image& image, const Image& reference, const TextTable& table,
                   const std::vector<std::string>& lines) {
    const Layout at({image.width, image.height}, table.size() + lines.size());
    Canvas canvas(at.width, at.height, dark_background);
    const std::array<const char*, 3> names{"image", "reference", "difference"};
    for (int i = 0; i < 3; ++i) {
        const int x = at.gap + i * (at.panel + at.gap), top = at.line + at.gap;
        canvas.text(x, at.line, at.scale, names[static_cast<std::size_t>(i)]);
        // Encoding to sRGB restores the error map's original 8-bit colours exactly.
        canvas.picture(x, top,
                       encoded_8bit(i == 0   ? image
                                    : i == 1 ? reference
                                             : error_map(image, reference)));
    }
    int y = at.text_top + at.line - at.gap / 2;
    for (const auto& row : table) {
        const auto text_width = static_cast<double>(at.width - 2 * at.gap);
        // The first column, which contains the names, is twice as wide.
        const double column = text_width / static_cast<double>(table.front().size() + 1);
        for (std::size_t i = 0; i < row.size(); ++i) {
            const double x = at.gap + (i == 0 ? 0 : static_cast<double>(i + 1) * column);
            canvas.text(static_cast<int>(x), y, at.scale, row[i]);
        }
        y += at.line;
    }
    for (const std::string& words : lines) {
        canvas.text(at.gap, y, at.scale, words);
        y += at.line;
    }
    return canvas.image();
}

}  // namespace postlens
