#include "compare/drawing/cause_picture.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "compare/drawing/canvas.h"
#include "pictures/srgb.h"

namespace postlens {
std::array<std::uint8_t, 3> cause_colour(ErrorCause cause) {
    constexpr std::array<std::array<std::uint8_t, 3>, error_causes> colours{{{90, 90, 90},
                                                                             {213, 94, 0},
                                                                             {0, 114, 178},
                                                                             {204, 121, 167},
                                                                             {240, 228, 66},
                                                                             {0, 158, 115},
                                                                             {86, 180, 233},
                                                                             {230, 159, 0},
                                                                             {255, 255, 255}}};
    return colours[static_cast<std::size_t>(cause)];
}

Image cause_picture(const CauseMap& map, const Image& reference) {
    const int width = std::max(map.width, least_legend_width_px);
    std::vector<std::size_t> listed;
    for (std::size_t c = 1; c < error_causes; ++c) {
        if (map.error_share[c] > 0) listed.push_back(c);
    }
    std::sort(listed.begin(), listed.end(),
              [&](std::size_t a, std::size_t b) { return map.error_share[a] > map.error_share[b]; });
    const double scale = std::clamp(width / 1280.0, 1.0, 8.0);
    const auto px = [scale](double v) { return static_cast<int>(std::lround(v * scale)); };
    const int legend = px(2 * text_margin_px + text_line_px * std::max(1, static_cast<int>(listed.size())));
    Canvas canvas(width, map.height + legend, dark_background);
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            const ErrorCause cause =
                map.causes[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                           static_cast<std::size_t>(x)];
            const float* rgb = reference.pixel(x, y);
            const float grey = srgb_from_linear(luminance(rgb));
            const auto level = static_cast<std::uint8_t>(std::lround(20 + 90 * grey));
            const Rgb8 dim{level, level, level};
            canvas.dot(x, y, cause == ErrorCause::none ? dim : cause_colour(cause));
        }
    }
    int y = map.height + px(text_margin_px);
    if (listed.empty()) canvas.text(px(text_margin_px), y + px(13), scale, "no pixel is wrong");
    for (const std::size_t c : listed) {
        canvas.fill(px(text_margin_px), y + px(2), px(14), px(12), cause_colour(static_cast<ErrorCause>(c)));
        canvas.text(px(text_margin_px + 22), y + px(13), scale,
                    fmt::format("{}: {:.1f} % of the error", cause_name(static_cast<ErrorCause>(c)),
                                100 * map.error_share[c]));
        y += px(text_line_px);
    }
    return canvas.image();
}

}  // namespace postlens
