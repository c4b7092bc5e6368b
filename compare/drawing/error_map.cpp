#include "compare/drawing/error_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "compare/drawing/canvas.h"
#include "core/threads.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr Rgb8 not_a_number{255, 0, 255};
constexpr int legend_px = 60;

// Text grows with the image, so that it stays legible when scaled to a screen.
double text_scale(int width) {
    return std::clamp(width / 1280.0, 1.0, 8.0);
}

std::vector<Rgb8> viridis() {
    cv::Mat ramp(1, 256, CV_8UC1), colours;
    for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
    cv::applyColorMap(ramp, colours, cv::COLORMAP_VIRIDIS);
    std::vector<Rgb8> out;
    for (int i = 0; i < 256; ++i) {
        const auto c = colours.at<cv::Vec3b>(0, i);  // OpenCV orders the channels blue, green, red
        out.push_back({c[2], c[1], c[0]});
    }
    return out;
}

// Returns the position of an error on the colour scale of the error map, from 0 (the smallest error shown) to
// 1 (the largest). The scale is logarithmic. `steps` is the error, the difference between two pixels, in
// steps of 8-bit sRGB (1/255).
double place(double steps) {
    const double whole = std::log(map_greatest_steps / map_least_steps);
    return std::clamp(std::log(std::max(steps, map_least_steps) / map_least_steps) / whole, 0.0, 1.0);
}

Rgb8 colour_of(const float* a, const float* b, const std::vector<Rgb8>& colours) {
    float greatest = 0;
    for (int c = 0; c < 3; ++c) {
        if (!std::isfinite(a[c]) || !std::isfinite(b[c])) return not_a_number;
        greatest = std::max(greatest, std::abs(srgb_from_linear(a[c]) - srgb_from_linear(b[c])));
    }
    return colours[static_cast<std::size_t>(std::lround(255 * place(255 * static_cast<double>(greatest))))];
}

void draw_legend(Canvas& canvas, int y0, int width, double scale, const std::vector<Rgb8>& colours) {
    const auto px = [scale](double v) { return static_cast<int>(std::lround(v * scale)); };
    const int x0 = px(text_margin_px), length = width - 2 * x0;
    canvas.text(x0, y0 + px(15), scale, "largest channel difference, in 8-bit sRGB steps (log scale)");
    for (int x = 0; x < length; ++x) {
        const double at = static_cast<double>(x) / std::max(1, length - 1);
        canvas.fill(x0 + x, y0 + px(22), 1, px(14), colours[static_cast<std::size_t>(std::lround(255 * at))]);
    }
    for (const auto& [steps, words] :
         {std::pair{0.1, "0.1"}, {1.0, "1"}, {10.0, "10"}, {100.0, "100"}, {255.0, "255"}}) {
        const int x = x0 + static_cast<int>(std::lround(place(steps) * (length - 1)));
        canvas.fill(x, y0 + px(36), std::max(1, px(1)), px(5), {235, 235, 235});
        const int text_px = Canvas::text_width(scale, words);
        canvas.text(std::clamp(x - text_px / 2, x0, x0 + length - text_px), y0 + px(54), scale, words);
    }
}

}  // namespace

ImageSize error_map_size(ImageSize pictures) {
    const int width = std::max(pictures.width, least_legend_width_px);
    return {width, pictures.height + static_cast<int>(std::lround(legend_px * text_scale(width)))};
}

Image error_map(const Image& image, const Image& reference) {
    const ImageSize size = error_map_size({image.width, image.height});
    Canvas canvas(size.width, size.height, dark_background);
    const std::vector<Rgb8> colours = viridis();
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < image.width; ++x)
            canvas.dot(x, y, colour_of(image.pixel(x, y), reference.pixel(x, y), colours));
    });
    draw_legend(canvas, image.height, size.width, text_scale(size.width), colours);
    return canvas.image();
}

}  // namespace postlens
