#include "motionblur/shutter_views.h"

#include <algorithm>
#include <bit>
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
    const double wanted = std::clamp(longest_px / 2, 1.0, static_cast<double>(most_views_by_itself));
    return std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(wanted)))), fewest_views,
                      most_views_by_itself);
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
