#include "planner/errors/records_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "focus/light_field/field_focus.h"
#include "focus/responses/depth_levels.h"
#include "pictures/srgb.h"
#include "planner/views/picture_request.h"
#include "reproject/no_rays.h"

namespace postlens {
namespace {

/// Number of views (images from different lens points) that are drawn to find the samples whose colour the
/// file does not determine. With 16 views, the fraction of such samples in a pixel is accurate to a few
/// hundredths.
constexpr int views_that_tell = 16;

/// The smallest and the largest value of each colour channel in the neighbourhood of a pixel. To save time,
/// they are stored for squares of 8 x 8 px instead of for pixels. They include all pixels up to `radius_px`
/// around a square.
class Ranges {
  public:
    Ranges(const Image& image, double radius_px)
        : columns_((image.width + square - 1) / square),
          rows_((image.height + square - 1) / square),
          reach_(static_cast<int>(std::min(std::ceil(radius_px / square), 1e4))) {
        ranges_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                Range& to = ranges_[at(x / square, y / square)];
                for (std::size_t c = 0; c < 3; ++c) to[c].add(image.pixel(x, y)[c]);
            }
        }
        widen(columns_, rows_, 1, columns_);
        widen(rows_, columns_, columns_, 1);
    }
    /// Returns the difference between the largest and the smallest value of a colour channel, within about
    /// `radius_px` of a pixel.
    [[nodiscard]] float span(int x, int y, std::size_t channel) const {
        const Bounds& b = ranges_[at(x / square, y / square)][channel];
        return b.high - b.low;
    }

  private:
    static constexpr int square = 8;  ///< px
    struct Bounds {
        float low = std::numeric_limits<float>::infinity(), high = -low;
        void add(float value) { low = std::min(low, value), high = std::max(high, value); }
        void add(const Bounds& other) { add(other.low), add(other.high); }
    };
    using Range = std::array<Bounds, 3>;
    [[nodiscard]] std::size_t at(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }
    void widen(int length, int lines, int step, int next) {
        std::vector<Range> before(static_cast<std::size_t>(length));
        for (int line = 0; line < lines; ++line) {
            const auto of = [&](int i) -> Range& {
                return ranges_[static_cast<std::size_t>(line) * static_cast<std::size_t>(next) +
                               static_cast<std::size_t>(i) * static_cast<std::size_t>(step)];
            };
            for (int i = 0; i < length; ++i) before[static_cast<std::size_t>(i)] = of(i);
            for (int i = 0; i < length; ++i) {
                for (int k = std::max(0, i - reach_); k <= std::min(length - 1, i + reach_); ++k) {
                    for (std::size_t c = 0; c < 3; ++c) of(i)[c].add(before[static_cast<std::size_t>(k)][c]);
                }
            }
        }
    }
    int columns_, rows_, reach_;
    std::vector<Range> ranges_;
};

}  // namespace

RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image) {
    const SampleFileReader& file = frame.file();
    const NoRays none;
    FieldFocusSettings by_field = field_settings(file.header(), lens);
    by_field.views = views_that_tell;
    by_field.rays = &none;
    RecordsBound out;
    out.unsure = field_focus(frame, by_field).traced;
    out.mse.resize(out.unsure.size());
    const Ranges ranges(pinhole_picture(file), largest_coc_px(depth_range(file), by_field.geometry) / 2 + 1);
    std::size_t k = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x, ++k) {
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const float value = image.pixel(x, y)[c], off = out.unsure[k] * ranges.span(x, y, c);
                const double is = static_cast<double>(srgb_from_linear(value)),
                             less = is - static_cast<double>(srgb_from_linear(value - off)),
                             more = static_cast<double>(srgb_from_linear(value + off)) - is;
                sum += std::max(less * less, more * more);
            }
            out.mse[k] = static_cast<float>(sum / 3);
        }
    }
    return out;
}

}  // namespace postlens
