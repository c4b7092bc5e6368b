#include "motionblur/shutter_views.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/sobol.h"

namespace postlens {

void check_views(const std::optional<int>& views) {
    if (views && (*views < 1 || *views > most_views)) {
        fail(ExitCode::wrong_arguments, "--views: out of range (got {}; expected 1 to {})", *views,
             most_views);
    }
}

glm::dvec2 place_in_pixel(std::uint32_t j, double places) {
    const std::uint32_t x = reverse_bits(sobol_reversed(0, j)), y = reverse_bits(sobol_reversed(1, j));
    constexpr double scale = 1.0 / 4294967296.0;
    return {x * scale + 0.5 / places, y * scale + 0.5 / places};
}

int views_for_way(double longest_px) {
    const auto enough = [&](int views) { return views >= longest_px / 2; };
    const auto* const found = std::find_if(automatic_views.begin(), automatic_views.end(), enough);
    return found != automatic_views.end() ? *found : automatic_views.back();
}

std::vector<ShutterView> shutter_views(const ShutterCurve& curve, const Exposure& exposure, int views) {
    std::vector<ShutterView> out;
    const int places = std::min(most_places, views);
    for (int i = 0; i < views; ++i) {
        const double share = curve.time((i + 0.5) / views);
        out.push_back({place_in_pixel(static_cast<std::uint32_t>(i % places), static_cast<double>(places)),
                       exposure.open_s + share * (exposure.close_s - exposure.open_s)});
    }
    return out;
}

}  // namespace postlens
