#include "compare/drawing/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "compare/drawing/opencv_style.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr double font_scale = 0.42;

int stroke_px(double scale) {
    return std::max(1, static_cast<int>(std::lround(scale)));
}

}  // namespace

Canvas::Canvas(int width, int height, Rgb8 background)
    : pixels_(height, width, CV_8UC3, scalar(background)) {}

void Canvas::fill(int x, int y, int width, int height, Rgb8 colour) {
    const cv::Rect inside = cv::Rect(x, y, width, height) & cv::Rect(0, 0, pixels_.cols, pixels_.rows);
    pixels_(inside).setTo(scalar(colour));
}

void Canvas::dot(int x, int y, Rgb8 colour) {
    pixels_.at<cv::Vec3b>(y, x) = cv::Vec3b(colour[0], colour[1], colour[2]);
}

void Canvas::picture(int x, int y, const EncodedPicture& picture) {
    for (int py = 0; py < picture.height; ++py)
        std::copy_n(picture.row(py), 3 * picture.width, pixels_.ptr<std::uint8_t>(y + py) + 3 * x);
}

void Canvas::text(int x, int y, double scale, const std::string& words) {
    cv::putText(pixels_, words, {x, y}, font, font_scale * scale, {235, 235, 235}, stroke_px(scale),
                cv::LINE_AA);
}

int Canvas::text_width(double scale, const std::string& words) {
    int base = 0;
    return cv::getTextSize(words, font, font_scale * scale, stroke_px(scale), &base).width;
}

Image Canvas::image() const {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = linear_from_srgb(static_cast<float>(i) / 255);
    Image out(pixels_.cols, pixels_.rows);
    for (int y = 0; y < pixels_.rows; ++y) {
        const auto* row = pixels_.ptr<std::uint8_t>(y);
        std::transform(row, row + 3 * static_cast<std::ptrdiff_t>(pixels_.cols), out.pixel(0, y),
                       [&linear](std::uint8_t v) { return linear[v]; });
    }
    return out;
}

EncodedPicture Canvas::encoded() const {
    EncodedPicture out(pixels_.cols, pixels_.rows);
    for (int y = 0; y < pixels_.rows; ++y)
        std::copy_n(pixels_.ptr<std::uint8_t>(y), 3 * pixels_.cols, out.row(y));
    return out;
}

}  // namespace postlens
