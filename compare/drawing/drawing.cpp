#include "compare/drawing/drawing.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "compare/drawing/opencv_style.h"
#include "core/error.h"
#include "core/files/output_file.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr double dash_px = 6, gap_px = 4;
constexpr int subpixel_bits = 6;

// Converts coordinates to OpenCV's fixed-point format. The limit of 1e5 px lets them fit into an int.
cv::Point fixed(Drawing::Point p) {
    static constexpr double far = 1e5;
    const auto to = [](double v) {
        return static_cast<int>(std::lround((std::clamp(v, -far, far) - 0.5) * (1 << subpixel_bits)));
    };
    return {to(p.x), to(p.y)};
}

std::string hex(Drawing::Colour c) {
    return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

std::string escaped(const std::string& words) {
    std::string out;
    for (const char c : words) {
        switch (c) {
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '&':
                out += "&amp;";
                break;
            default:
                // Replaces control characters and non-ASCII bytes, for instance of file names, because they
                // can make the XML invalid.
                out += static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E ? '?' : c;
        }
    }
    return out;
}

std::string path_of(const std::vector<Drawing::Point>& points) {
    std::string out;
    for (const Drawing::Point& p : points)
        out += fmt::format("{}{:.2f},{:.2f}", out.empty() ? "" : " ", p.x, p.y);
    return out;
}

// Returns the pieces of a dashed line.
std::vector<std::pair<Drawing::Point, Drawing::Point>> dashes(Drawing::Point a, Drawing::Point b) {
    std::vector<std::pair<Drawing::Point, Drawing::Point>> out;
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const auto at = [&](double s) {
        return Drawing::Point{a.x + (b.x - a.x) * s / length, a.y + (b.y - a.y) * s / length};
    };
    for (double s = 0; s < length; s += dash_px + gap_px)
        out.emplace_back(at(s), at(std::min(s + dash_px, length)));
    return out;
}

}  // namespace

void Drawing::line(std::vector<Point> points, Colour colour, double width_px, bool dashed) {
    parts_.push_back({Kind::line, std::move(points), {}, colour, width_px, dashed, {}, {}});
}

void Drawing::area(std::vector<Point> points, Colour fill, Colour edge, double width_px) {
    parts_.push_back({Kind::area, std::move(points), fill, edge, width_px, false, {}, {}});
}

void Drawing::dot(Point at, double radius_px, Colour colour) {
    parts_.push_back({Kind::dot, {at}, colour, {}, radius_px, false, {}, {}});
}

void Drawing::text(Point at, double size_px, const std::string& words, Anchor anchor) {
    parts_.push_back({Kind::text, {at}, {}, {}, size_px, false, words, anchor});
}

std::string Drawing::svg() const {
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
        width_, height_);
    for (const Part& p : parts_) {
        switch (p.kind) {
            case Kind::line:
                out += fmt::format(
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2f}\"{}/>\n",
                    path_of(p.points), hex(p.edge), p.size,
                    p.dashed ? fmt::format(" stroke-dasharray=\"{} {}\"", dash_px, gap_px) : "");
                break;
            case Kind::area:
                out += fmt::format(
                    "<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{:.2f}\"/>\n",
                    path_of(p.points), hex(p.fill), hex(p.edge), p.size);
                break;
            case Kind::dot:
                out += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\"/>\n",
                                   p.points[0].x, p.points[0].y, p.size, hex(p.fill));
                break;
            case Kind::text:
                out += fmt::format(
                    "<text x=\"{:.2f}\" y=\"{:.2f}\" font-family=\"sans-serif\" font-size=\"{:.1f}\" "
                    "text-anchor=\"{}\">{}</text>\n",
                    p.points[0].x, p.points[0].y, p.size,
                    p.anchor == Anchor::start    ? "start"
                    : p.anchor == Anchor::middle ? "middle"
                                                 : "end",
                    escaped(p.words));
        }
    }
    return out + "</svg>\n";
}

Image Drawing::image() const {
    cv::Mat pixels(height_, width_, CV_8UC3, cv::Scalar(255, 255, 255));
    for (const Part& p : parts_) {
        std::vector<cv::Point> points;
        for (const Point& q : p.points) points.push_back(fixed(q));
        const int stroke = std::max(1, static_cast<int>(std::lround(p.size)));
        switch (p.kind) {
            case Kind::line:
                if (p.dashed) {
                    for (std::size_t i = 0; i + 1 < p.points.size(); ++i) {
                        for (const auto& [a, b] : dashes(p.points[i], p.points[i + 1]))
                            cv::line(pixels, fixed(a), fixed(b), scalar(p.edge), stroke, cv::LINE_AA,
                                     subpixel_bits);
                    }
                } else {
                    cv::polylines(pixels, points, false, scalar(p.edge), stroke, cv::LINE_AA, subpixel_bits);
                }
                break;
            case Kind::area:
                cv::fillPoly(pixels, points, scalar(p.fill), cv::LINE_AA, subpixel_bits);
                cv::polylines(pixels, points, true, scalar(p.edge), stroke, cv::LINE_AA, subpixel_bits);
                break;
            case Kind::dot:
                cv::circle(pixels, points[0],
                           std::max(1, static_cast<int>(std::lround(p.size * (1 << subpixel_bits)))),
                           scalar(p.fill), cv::FILLED, cv::LINE_AA, subpixel_bits);
                break;
            case Kind::text: {
                // The font's capitals are 21 px high at scale 1.
                const double scale = p.size / 1.4 / 21;
                int base = 0;
                const int width = cv::getTextSize(p.words, font, scale, 1, &base).width;
                const int shift = p.anchor == Anchor::start    ? 0
                                  : p.anchor == Anchor::middle ? width / 2
                                                               : width;
                cv::putText(pixels, p.words,
                            {static_cast<int>(std::lround(p.points[0].x)) - shift,
                             static_cast<int>(std::lround(p.points[0].y))},
                            font, scale, {30, 30, 30}, 1, cv::LINE_AA);
            }
        }
    }
    Image out(width_, height_);
    for (int y = 0; y < height_; ++y) {
        const auto* row = pixels.ptr<std::uint8_t>(y);
        std::transform(row, row + 3 * static_cast<std::ptrdiff_t>(width_), out.pixel(0, y),
                       [](std::uint8_t v) { return linear_from_srgb(static_cast<float>(v) / 255); });
    }
    return out;
}

void check_drawing_path(const std::filesystem::path& path, const char* others) {
    if (path.extension() == ".svg" || path.extension() == ".SVG") return;
    try {
        check_image_path(path);
    } catch (const Error&) {
        fail(ExitCode::wrong_arguments,
             "{}: unknown kind of drawing (got ending \"{}\"; expected {}svg, exr, png, tif or jpg)",
             path.string(), path.extension().string(), others);
    }
}

void write_drawing(const std::filesystem::path& path, const Drawing& drawing) {
    if (path.extension() != ".svg" && path.extension() != ".SVG") {
        write_image(path, drawing.image());
        return;
    }
    OutputFile file(path);
    file.write(drawing.svg());
    file.commit();
}

}  // namespace postlens
