#include "sweep/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/drawing/canvas.h"
#include "core/multiversion.h"
#include "core/threads.h"

namespace postlens {
namespace {

constexpr Rgb8 background{24, 24, 24}, not_there{48, 48, 48};
constexpr int gap_px = 6, line_px = 18;
/// The contact sheet is about `wide_px` wide. Its thumbnails are `least_px` to `most_px` wide.
constexpr int wide_px = 2400, least_px = 72, most_px = 320;
constexpr std::size_t most_columns = wide_px / (least_px + gap_px);

/// Returns the number of columns of the contact sheet. This is the requested number, `wanted`, if it gives
/// several rows and columns of thumbnails that are large enough. Otherwise, it is the number of columns of a
/// roughly square grid.
std::size_t columns_for(std::size_t pictures, std::size_t wanted) {
    if (wanted > 1 && wanted < pictures && wanted <= most_columns) return wanted;
    const auto square = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(pictures))));
    return std::clamp<std::size_t>(square, 1, most_columns);
}

/// The source pixels [begin, end) under one pixel of the smaller image, along one axis. `first` and `last`
/// are the covered fractions of the two end pixels.
struct Span {
    int begin = 0, end = 0;
    double first = 1, last = 1;
    [[nodiscard]] double weight(int i) const { return i == begin ? first : i == end - 1 ? last : 1; }
};

Span span_of(int i, int to, int from) {
    const double scale = static_cast<double>(from) / to, low = i * scale, high = (i + 1) * scale;
    Span out;
    out.begin = static_cast<int>(low);
    out.end = std::clamp(static_cast<int>(std::ceil(high - 1e-9)), out.begin + 1, from);
    out.first = std::min(high, out.begin + 1.0) - low;
    out.last = high - (out.end - 1);
    return out;
}

POSTLENS_MULTIVERSION
void add_weighted(const float* __restrict from, double weight, std::size_t count, double* __restrict to) {
    for (std::size_t i = 0; i < count; ++i) to[i] += weight * static_cast<double>(from[i]);
}

}  // namespace

Image made_smaller(const Image& image, int width, int height) {
    if (width == image.width && height == image.height) return image;
    Image out(width, height);
    const auto values = static_cast<std::size_t>(image.width) * 3;
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const Span rows = span_of(static_cast<int>(row), height, image.height);
        std::vector<double> means(values);
        double high = 0;
        for (int v = rows.begin; v < rows.end; ++v) high += rows.weight(v);
        for (int v = rows.begin; v < rows.end; ++v)
            add_weighted(image.pixel(0, v), rows.weight(v) / high, values, means.data());
        for (int x = 0; x < width; ++x) {
            const Span columns = span_of(x, width, image.width);
            double sum[3] = {0, 0, 0}, wide = 0;
            for (int u = columns.begin; u < columns.end; ++u) {
                const double w = columns.weight(u);
                const double* mean = means.data() + 3 * static_cast<std::size_t>(u);
                for (std::size_t c = 0; c < 3; ++c) sum[c] += w * mean[c];
                wide += w;
            }
            float* to = out.pixel(x, static_cast<int>(row));
            for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<float>(sum[c] / wide);
        }
    });
    return out;
}

ContactSheet::ContactSheet(ImageSize picture, std::vector<std::string> captions, std::size_t columns)
    : captions_(std::move(captions)),
      columns_(columns_for(captions_.size(), columns)),
      small_(captions_.size()) {
    const int room = wide_px / static_cast<int>(columns_) - gap_px;
    width_ = std::min({picture.width, std::clamp(room, least_px, most_px)});
    height_ = std::max(
        1, static_cast<int>(std::lround(static_cast<double>(width_) * picture.height / picture.width)));
    height_ = std::min(height_, picture.height);
}

void ContactSheet::set(std::size_t i, const Image& picture) {
    small_[i] = encoded_8bit(
        made_smaller(picture, std::min(width_, picture.width), std::min(height_, picture.height)));
}

EncodedPicture ContactSheet::picture() const {
    // The longest caption determines the font size of all.
    int widest = 1;
    for (const std::string& c : captions_) widest = std::max(widest, Canvas::text_width(1, c));
    const double scale = std::min(1.0, static_cast<double>(width_) / widest);
    const int line = static_cast<int>(std::lround(line_px * std::max(scale, 0.4)));
    const int rows = static_cast<int>((captions_.size() + columns_ - 1) / columns_);
    const int step_x = width_ + gap_px, step_y = height_ + line + gap_px;
    Canvas canvas(static_cast<int>(columns_) * step_x + gap_px, rows * step_y + gap_px, background);
    for (std::size_t i = 0; i < captions_.size(); ++i) {
        const int x = gap_px + static_cast<int>(i % columns_) * step_x,
                  y = gap_px + static_cast<int>(i / columns_) * step_y;
        if (small_[i].rgb.empty()) {
            canvas.fill(x, y, width_, height_, not_there);
        } else {
            canvas.picture(x, y, small_[i]);
        }
        canvas.text(x, y + height_ + line - line / 3, scale, captions_[i]);
    }
    return canvas.encoded();
}

}  // namespace postlens
