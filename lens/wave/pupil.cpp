#include "lens/wave/pupil.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace postlens {

Transmission circular_aperture() {
    return [](double x, double y) { return x * x + y * y <= 1 ? 1.0 : 0.0; };
}

Transmission polygon_aperture(std::vector<glm::dvec2> corners) {
    if (corners.size() < 3) {
        fail(ExitCode::wrong_arguments, "polygon has too few corners (got {}; expected at least 3)",
             corners.size());
    }
    for (const glm::dvec2& c : corners) {
        if (!(std::abs(c.x) <= 1 && std::abs(c.y) <= 1)) {
            fail(ExitCode::wrong_arguments,
                 "corner of the polygon is out of range (got {}, {}; expected -1 to 1)", c.x, c.y);
        }
    }
    return [corners = std::move(corners)](double x, double y) {
        bool inside = false;
        for (std::size_t i = 0, before = corners.size() - 1; i < corners.size(); before = i++) {
            const glm::dvec2 &a = corners[i], &b = corners[before];
            if ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
        }
        return inside ? 1.0 : 0.0;
    };
}

Transmission picture_aperture(int width, int height, std::vector<float> values) {
    if (width < 1 || height < 1 ||
        values.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        fail(ExitCode::wrong_arguments,
             "picture of an aperture has no pixels (got {}x{}; expected at least 1x1)", width, height);
    }
    float most = 0;
    for (const float value : values) {
        if (!(value >= 0 && value <= 1)) {
            fail(ExitCode::wrong_arguments,
                 "transmission of an aperture is out of range (got {}; expected 0 to 1)", value);
        }
        most = std::max(most, value);
    }
    if (most == 0) fail(ExitCode::wrong_arguments, "aperture lets no light through (got a black picture)");
    const double per_unit = std::max(width, height) / 2.0;
    return [width, height, per_unit, values = std::move(values)](double x, double y) {
        const double column = x * per_unit + width / 2.0, row = y * per_unit + height / 2.0;
        if (column < 0 || row < 0 || column > width || row > height) return 0.0;
        const double c = std::clamp(column - 0.5, 0.0, width - 1.0);
        const double r = std::clamp(row - 0.5, 0.0, height - 1.0);
        const int c0 = static_cast<int>(c), r0 = static_cast<int>(r);
        const auto at = [&](int i, int j) {
            const int ci = std::min(i, width - 1), rj = std::min(j, height - 1);
            return static_cast<double>(values[static_cast<std::size_t>(rj) * static_cast<std::size_t>(width) +
                                              static_cast<std::size_t>(ci)]);
        };
        const double s = c - c0, t = r - r0;
        return (1 - t) * ((1 - s) * at(c0, r0) + s * at(c0 + 1, r0)) +
               t * ((1 - s) * at(c0, r0 + 1) + s * at(c0 + 1, r0 + 1));
    };
}

}  // namespace postlens
