#include "pictures/foreign/foreign_picture.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"

namespace postlens {

std::uint32_t surface_id(float value, bool whole) {
    return !whole && (value == 0 || std::isnan(value)) ? 0 : std::bit_cast<std::uint32_t>(value);
}

double transmittance_behind(std::span<const StackSample> stack, bool is_nothing_behind) {
    double left = 1;
    bool opaque = false;
    for (const StackSample& s : stack) {
        const double through = 1 - static_cast<double>(s.alpha);
        left = opaque ? through : left * through;
        opaque = through <= opaque_transmittance;
    }
    return is_nothing_behind && left <= opaque_transmittance ? 1 : left;
}

namespace {

struct Composited {
    std::array<float, 3> rgb{};
    float alpha = 0;
};

Composited composited(std::span<const StackSample> stack) {
    double left = 1, held_out = 0;
    std::array<double, 3> rgb{};
    for (const StackSample& s : stack) {
        if (s.holdout) {
            held_out += left * static_cast<double>(s.alpha);
        } else {
            rgb[0] += left * static_cast<double>(s.r);
            rgb[1] += left * static_cast<double>(s.g);
            rgb[2] += left * static_cast<double>(s.b);
        }
        left *= 1 - static_cast<double>(s.alpha);
    }
    return {{static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])},
            static_cast<float>(std::max(0.0, 1 - left - held_out))};
}

}  // namespace

Image ForeignPicture::flattened() const {
    require_memory(static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * 4 * sizeof(float),
                   "the picture of the display window");
    Image out(width, height);
    std::vector<float> alpha(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0F);
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < width; ++x) {
            if (!stores(x, y)) continue;
            const Composited pixel = composited(stack(x, y));
            std::copy(pixel.rgb.begin(), pixel.rgb.end(), out.pixel(x, y));
            alpha[row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = pixel.alpha;
        }
    });
    if (std::any_of(alpha.begin(), alpha.end(), [](float a) { return a < 1; })) out.alpha = std::move(alpha);
    return out;
}

bool ForeignPicture::is_opaque() const {
    std::atomic<bool> opaque = x_begin <= 0 && x_end >= width && y_begin <= 0 && y_end >= height;
    const auto columns = static_cast<std::size_t>(std::max(0, x_end - x_begin));
    parallel_for(static_cast<std::size_t>(std::max(0, y_end - y_begin)), [&](std::size_t row) {
        for (std::size_t i = row * columns; i < (row + 1) * columns && opaque; ++i) {
            const auto samples_here = stack_of(i);
            if (samples_here.size() == 1 && samples_here[0].alpha == 1 && !samples_here[0].holdout) continue;
            if (composited(samples_here).alpha < 1 || std::any_of(samples_here.begin(), samples_here.end(),
                                                                  [](const auto& s) { return s.holdout; }))
                opaque = false;
        }
    });
    return opaque;
}

double ForeignPicture::depth_at(double x, double y) const {
    const double column = std::floor(x), row = std::floor(y);
    if (!(column >= x_begin && column < x_end && row >= y_begin && row < y_end)) {
        fail(ExitCode::wrong_arguments,
             "--focus-at: outside the stored pixels (got {},{}; expected {} <= X < {}, {} <= Y < {})", x, y,
             x_begin, x_end, y_begin, y_end);
    }
    const StackSample* seen = seen_sample(static_cast<int>(column), static_cast<int>(row));
    return seen != nullptr && seen->inverse_z > 0 ? 1 / static_cast<double>(seen->inverse_z)
                                                  : std::numeric_limits<double>::infinity();
}

}  // namespace postlens
