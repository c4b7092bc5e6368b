// Images of other programs from a function, and what tests read of them.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "focus/foreign_focus.h"

namespace postlens::test {

using Stack = std::vector<StackSample>;

/// Makes images of other programs and focuses them: a raster of 36 mm width before a film distance that makes
/// `gain_px` 1000 px, and a lens of 2 m diameter, so that what has the inverse depth 1/s - k/1000 has a
/// signed radius of k px.
struct StackBench {
    int width = 64, height = 8;
    int margin_px = 0;  ///< stored beyond the raster
    double inverse_focus_per_m = 1;
    FocusSettings settings;

    [[nodiscard]] ForeignPicture picture(const std::function<Stack(int x, int y)>& stack_at) const {
        ForeignPicture p;
        p.width = width;
        p.height = height;
        p.x_begin = p.y_begin = -margin_px;
        p.x_end = width + margin_px;
        p.y_end = height + margin_px;
        p.camera.film_width_mm = 36;
        p.camera.film_distance_mm = 1000 * 36.0 / width;
        for (int y = p.y_begin; y < p.y_end; ++y) {
            for (int x = p.x_begin; x < p.x_end; ++x) {
                for (const StackSample& s : stack_at(x, y)) p.samples.push_back(s);
                p.offsets.push_back(p.samples.size());
            }
        }
        return p;
    }
    [[nodiscard]] float inverse_z(double signed_radius_px) const {
        return static_cast<float>(inverse_focus_per_m - signed_radius_px / 1000);
    }
    [[nodiscard]] FocusResult focus(const ForeignPicture& p, FocusMethod method) const {
        FocusSettings s = settings;
        s.method = method;
        s.lens = {.focal_length_mm = 2000, .f_number = 1};
        s.focus_distance_m = 1 / inverse_focus_per_m;
        return focus_foreign(p, s);
    }
};

inline double edge_response(double t) {
    if (t <= -1) return 0;
    if (t >= 1) return 1;
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
}

inline float value(const Image& image, int x, int y, std::size_t c) {
    return image.pixel(x, y)[c];
}

inline float alpha(const Image& image, int x, int y) {
    return image.alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(x)];
}

}  // namespace postlens::test
