#include "focus/bend_warning.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "core/threads.h"

namespace postlens {
namespace {

constexpr double most_px = 0.5;
constexpr float darkest = 1.0F / 255;  // what is darker no eight-bit picture shows

/// Which nodes a lens shows elsewhere than W says.
class Misplaced {
  public:
    explicit Misplaced(const FocusGeometry& lens)
        : px_per_bend_(lens.gain_px * lens.aperture_radius_m * lens.aperture_radius_m) {}
    [[nodiscard]] bool possible(const SampleHeader& h) const { return h.has_bend && px_per_bend_ > 0; }
    bool operator()(const Record& r) const {
        return r.layer == 0 && std::max({r.r, r.g, r.b}) > darkest &&
               px_per_bend_ * static_cast<double>(r.w_bend) > most_px;
    }

  private:
    double px_per_bend_;
};

/// Half the width of a node's blur, px.
double blur_px(const Record& r, const FocusGeometry& lens) {
    const double s = lens.inverse_focus_per_m;
    const double a = s - static_cast<double>(r.w.xx), b = static_cast<double>(r.w.xy),
                 c = static_cast<double>(r.w.yx), d = s - static_cast<double>(r.w.yy);
    return lens.gain_px * lens.aperture_radius_m * std::sqrt((a * a + b * b + c * c + d * d) / 2);
}

}  // namespace

std::vector<float> misplaced_light(FocusFrame& frame, const FocusGeometry& lens) {
    const SampleFileReader& file = frame.file();
    const SampleHeader& h = file.header();
    const Misplaced misplaced(lens);
    if (!misplaced.possible(h)) return {};
    // Squares as differences in both directions, which one pass over the picture then sums up.
    const auto stride = static_cast<std::size_t>(h.width) + 1;
    std::vector<double> sums(stride * (static_cast<std::size_t>(h.height) + 1), 0);
    bool any = false;
    frame.visit_rows(file.y_begin(), file.y_end(), [&](const FrameRows& rows) {
        const RecordBand& band = *rows.band;
        for (std::size_t k = band.pixel(band.x_begin, rows.y_begin),
                         last_pixel = band.pixel(band.x_begin, rows.y_end);
             k < last_pixel; ++k) {
            const auto first = band.records.begin() + band.offsets[k],
                       last = band.records.begin() + band.offsets[k + 1];
            const auto samples = static_cast<double>(std::count_if(
                first, last, [](const Record& r) { return r.layer == 0 && r.path.bits() == 0; }));
            for (auto r = first; r != last; ++r) {
                if (!misplaced(*r)) continue;
                any = true;
                const double half = std::clamp(blur_px(*r, lens), 0.5, 1e5),
                             light = static_cast<double>(std::max({r->r, r->g, r->b})) / samples /
                                     (4 * half * half);
                const auto at = [](double v, int count) {
                    return static_cast<std::size_t>(std::clamp(std::lround(v), 0L, static_cast<long>(count)));
                };
                const std::size_t x0 = at(static_cast<double>(r->x) - half, h.width),
                                  x1 = at(static_cast<double>(r->x) + half, h.width),
                                  y0 = at(static_cast<double>(r->y) - half, h.height),
                                  y1 = at(static_cast<double>(r->y) + half, h.height);
                sums[y0 * stride + x0] += light;
                sums[y0 * stride + x1] -= light;
                sums[y1 * stride + x0] -= light;
                sums[y1 * stride + x1] += light;
            }
        }
    });
    if (!any) return {};
    std::vector<float> out(static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height));
    std::vector<double> above(stride, 0);
    for (std::size_t y = 0; y < static_cast<std::size_t>(h.height); ++y) {
        double row = 0;
        for (std::size_t x = 0; x < static_cast<std::size_t>(h.width); ++x) {
            row += sums[y * stride + x];
            above[x] += row;
            out[y * static_cast<std::size_t>(h.width) + x] = static_cast<float>(std::max(0.0, above[x]));
        }
    }
    return out;
}

std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens) {
    const SampleHeader& h = frame.file().header();
    const Misplaced is_misplaced(lens);
    if (!is_misplaced.possible(h)) return std::nullopt;
    std::vector<int> misplaced(static_cast<std::size_t>(h.height), 0);
    frame.visit_rows(0, h.height, [&](const FrameRows& rows) {
        const RecordBand& band = *rows.band;
        const int begin = std::max(rows.y_begin, 0), end = std::min(rows.y_end, h.height);
        parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
            const int y = begin + static_cast<int>(i);
            for (int x = 0; x < h.width; ++x) {
                const std::size_t k = band.pixel(x, y);
                if (std::any_of(band.records.begin() + band.offsets[k],
                                band.records.begin() + band.offsets[k + 1], is_misplaced))
                    ++misplaced[static_cast<std::size_t>(y)];
            }
        });
    });
    double pixels = 0;
    for (const int of_row : misplaced) pixels += of_row;
    if (pixels == 0) return std::nullopt;
    const double share = pixels / h.width / h.height;
    return FocusWarning{
        .code = "nonlinear",
        .share = share,
        .text = fmt::format("{:.1f} % of the pixels show something in a mirror or in glass that other points "
                            "of the lens see more than {} px from where its W puts it, or not at all",
                            100 * share, most_px)};
}

}  // namespace postlens
