#include "pictures/foreign/foreign_picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"

namespace postlens {

std::uint32_t surface_id(float value, bool whole) {
    return !whole && (value == 0 || std::isnan(value)) ? 0 : std::bit_cast<std::uint32_t>(value);
}

Image ForeignPicture::flattened() const {
    require_memory(static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * 4 * sizeof(float),
                   "the picture of the display window");
    Image out(width, height);
    std::vector<float> alpha(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0F);
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < width; ++x) {
            if (!stores(x, y)) continue;
            double left = 1, held_out = 0;
            std::array<double, 3> rgb{};
            for (const StackSample& s : stack(x, y)) {
                if (s.holdout) {
                    held_out += left * static_cast<double>(s.alpha);
                } else {
                    rgb[0] += left * static_cast<double>(s.r);
                    rgb[1] += left * static_cast<double>(s.g);
                    rgb[2] += left * static_cast<double>(s.b);
                }
                left *= 1 - static_cast<double>(s.alpha);
            }
            for (std::size_t c = 0; c < 3; ++c) out.pixel(x, y)[c] = static_cast<float>(rgb[c]);
            alpha[row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                static_cast<float>(std::max(0.0, 1 - left - held_out));
        }
    });
    if (std::any_of(alpha.begin(), alpha.end(), [](float a) { return a < 1; })) out.alpha = std::move(alpha);
    return out;
}

double ForeignPicture::depth_at(double x, double y) const {
    const double column = std::floor(x), row = std::floor(y);
    if (!(column >= x_begin && column < x_end && row >= y_begin && row < y_end)) {
        fail(ExitCode::wrong_arguments, "--focus-at: out of range (got {},{}; expected 0 to {}, 0 to {})", x,
             y, width, height);
    }
    const StackSample* seen = seen_sample(static_cast<int>(column), static_cast<int>(row));
    return seen != nullptr && seen->inverse_z > 0 ? 1 / static_cast<double>(seen->inverse_z)
                                                  : std::numeric_limits<double>::infinity();
}

}  // namespace postlens
