// Images of other programs, made by a function of the pixel, and focused.
#pragma once

#include <functional>
#include <vector>

#include "focus/foreign_focus.h"

namespace postlens::test {

/// The samples of a pixel, nearest first.
using Stack = std::vector<StackSample>;

/// Makes images of other programs and focuses them. The film is 36 mm wide, at a film distance of 1000 pixel
/// pitches. The diameter of the lens is 2 m, so that the inverse depth 1/s - k/1000 has a signed CoC radius
/// of k px.
struct StackBench {
    int width = 64, height = 8;
    int margin_px = 0;  ///< pixels that are stored beyond each side of the raster
    double inverse_focus_per_m = 1;
    FocusSettings settings;

    /// The image whose pixel (x, y) has the samples `stack_at(x, y)`.
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
    /// The inverse depth at which the CoC has this signed radius; positive behind the focus.
    [[nodiscard]] float inverse_z(double signed_radius_px) const {
        return static_cast<float>(inverse_focus_per_m - signed_radius_px / 1000);
    }
    /// Focuses the image at 1 / `inverse_focus_per_m`.
    [[nodiscard]] FocusResult focus(const ForeignPicture& p, FocusMethod method) const {
        FocusSettings s = settings;
        s.method = method;
        s.lens = {.focal_length_mm = 2000, .f_number = 1};
        s.focus_distance_m = 1 / inverse_focus_per_m;
        return focus_foreign(p, s);
    }
};

/// Channel c of pixel (x, y).
inline float value(const Image& image, int x, int y, std::size_t c) {
    return image.pixel(x, y)[c];
}

/// The alpha of pixel (x, y).
inline float alpha(const Image& image, int x, int y) {
    return image.alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(x)];
}

}  // namespace postlens::test
