#include "focus/bend_warning.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "core/text.h"
#include "focus/largest_bends.h"
#include "reproject/patches/patches.h"

namespace postlens {
namespace {

/// Tests whether a surface sample is misplaced, that is, drawn at a wrong position when it is reprojected to
/// other lens points. Reprojection assumes that a sample moves linearly with the lens point. The error of
/// this assumption is largest at the lens's rim, so it is computed there.
class Misplaced {
  public:
    explicit Misplaced(const FocusGeometry& lens)
        : px_per_bend_(lens.gain_px * lens.aperture_radius_m * lens.aperture_radius_m) {}
    [[nodiscard]] bool possible(const SampleHeader& h) const { return h.has_bend && px_per_bend_ > 0; }
    /// A sample is misplaced if its position at the lens's rim is wrong by more than most_bend_px pixels.
    [[nodiscard]] bool by_bend(float bend) const {
        return px_per_bend_ * static_cast<double>(bend) > most_bend_px;
    }
    bool operator()(const Record& r) const {
        return r.layer == 0 && std::max({r.r, r.g, r.b}) > darkest_shown && by_bend(r.w_bend);
    }

  private:
    double px_per_bend_;  ///< error of a node's position seen from the lens's rim, in px, for a w_bend of 1
};

/// Returns the blur radius of a surface sample, in px. The blur of a sample is an ellipse, and this radius is
/// the root mean square of its semi-axes.
double blur_px(const Record& r, const FocusGeometry& lens) {
    // The matrix gain R (I / s - W) maps the unit disc (the lens) to the ellipse. I is the unit matrix, R the
    // aperture radius, s the focus distance, and gain the film distance in px. W, in 1/m, tells how the
    // sample's image shifts when the lens point moves.
    const double s = lens.inverse_focus_per_m;
    const double a = s - static_cast<double>(r.w.xx), b = static_cast<double>(r.w.xy),
                 c = static_cast<double>(r.w.yx), d = s - static_cast<double>(r.w.yy);
    return lens.gain_px * lens.aperture_radius_m * std::sqrt((a * a + b * b + c * c + d * d) / 2);
}

}  // namespace

MisplacedLight::MisplacedLight(const SampleHeader& header, const FocusGeometry& lens)
    : lens_(lens), width_(header.width), height_(header.height), possible_(Misplaced(lens).possible(header)) {
    if (possible_)
        light_.assign((static_cast<std::size_t>(width_) + 1) * (static_cast<std::size_t>(height_) + 1), 0);
}

void MisplacedLight::add(const RecordBand& band, int y_begin, int y_end) {
    if (!possible_) return;
    const Misplaced misplaced(lens_);
    const auto stride = static_cast<std::size_t>(width_) + 1;
    const std::size_t end = band.pixel(band.x_begin, y_end);
    for (std::size_t k = band.pixel(band.x_begin, y_begin); k < end; ++k) {
        const auto first = band.records.begin() + band.offsets[k],
                   last = band.records.begin() + band.offsets[k + 1];
        const auto samples = static_cast<double>(
            std::count_if(first, last, [](const Record& r) { return r.layer == 0 && r.path.bits() == 0; }));
        for (auto r = first; r != last; ++r) {
            if (!misplaced(*r)) continue;
            any_ = true;
            const double half = std::clamp(blur_px(*r, lens_), 0.5, 1e5),
                         light =
                             static_cast<double>(std::max({r->r, r->g, r->b})) / samples / (4 * half * half);
            const auto at = [](double v, int count) {
                return static_cast<std::size_t>(std::clamp(std::lround(v), 0L, static_cast<long>(count)));
            };
            const std::size_t x0 = at(static_cast<double>(r->x) - half, width_),
                              x1 = at(static_cast<double>(r->x) + half, width_),
                              y0 = at(static_cast<double>(r->y) - half, height_),
                              y1 = at(static_cast<double>(r->y) + half, height_);
            light_[y0 * stride + x0] += light;
            light_[y0 * stride + x1] -= light;
            light_[y1 * stride + x0] -= light;
            light_[y1 * stride + x1] += light;
        }
    }
}

std::vector<float> MisplacedLight::picture() const {
    if (!any_) return {};
    const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_),
               stride = width + 1;
    std::vector<float> out(width * height);
    std::vector<double> above(stride, 0);
    for (std::size_t y = 0; y < height; ++y) {
        double row = 0;
        for (std::size_t x = 0; x < width; ++x) {
            row += light_[y * stride + x];
            above[x] += row;
            out[y * width + x] = static_cast<float>(std::max(0.0, above[x]));
        }
    }
    return out;
}

std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                         const std::optional<Crop>& crop) {
    const SampleHeader& h = frame.file().header();
    const Misplaced is_misplaced(lens);
    if (!is_misplaced.possible(h)) return std::nullopt;
    const Crop looked_at = crop.value_or(Crop{0, 0, h.width, h.height});
    const int first = looked_at.y, last = looked_at.y + looked_at.height;
    const LargestBends& bends = frame.largest_bends(first, last);
    std::int64_t pixels = 0;
    for (int y = first; y < last; ++y) {
        const float* row = bends.row(y);
        pixels += std::count_if(row + looked_at.x, row + looked_at.x + looked_at.width,
                                [&](float bend) { return is_misplaced.by_bend(bend); });
    }
    if (pixels == 0) return std::nullopt;
    const double share = static_cast<double>(pixels) / looked_at.width / looked_at.height;
    return FocusWarning{
        .code = "nonlinear",
        .share = share,
        .text =
            fmt::format("in {} % of the pixels a mirror or glass shows something that is displaced by more "
                        "than {} px, or is not seen, from some points of the lens (expected --method "
                        "hybrid with --scene, which traces rays there)",
                        rough(100 * share), most_bend_px)};
}

}  // namespace postlens
