#include "compare/metrics/flip.h"

#include <algorithm>
#include <cmath>

#include "compare/metrics/flip_tile.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

// Largest range, in stops, of the exposures at which HDR-FLIP compares images. It is the range of brightness
// that normal half floats can store, 2^-14 to 2^16.
constexpr double most_stops = 30;

// Returns the luminance of a pixel. Negative channels count as 0.
double positive_luminance(const float* p) {
    const auto positive = [](float v) { return static_cast<double>(std::max(v, 0.0F)); };
    return luminance(positive(p[0]), positive(p[1]), positive(p[2]));
}

// Returns the median: the mean of the two middle values if their number is even. Reorders `values`.
double median(std::vector<double>& values) {
    const std::size_t half = values.size() / 2;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(half);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace

std::vector<float> flip_map(const Image& reference, const Image& test, const PixelMask& usable) {
    std::vector<float> map;
    flip_errors(reference, test, usable, {FlipDisplay()}, map);
    return map;
}

FlipExposures flip_exposures(const Image& reference, const PixelMask& usable,
                             std::optional<double> white_luminance) {
    double greatest = 0, middle = 0;
    if (white_luminance) {
        greatest = *white_luminance;
        middle = std::min(0.18, greatest);
    } else {
        std::vector<double> values;
        for (std::size_t i = 0; i < usable.size(); ++i) {
            if (usable[i] != 0) values.push_back(positive_luminance(reference.rgb.data() + 3 * i));
        }
        if (!values.empty()) greatest = *std::max_element(values.begin(), values.end());
        if (greatest == 0) return {};
        middle = median(values);
        if (middle == 0) {
            values.erase(std::remove(values.begin(), values.end(), 0.0), values.end());
            middle = median(values);
        }
    }
    const double shown = flip_tone_curve_inverse(0.85);
    FlipExposures out;
    out.start = std::log2(shown / greatest);
    out.stop = std::min(std::log2(shown / middle), out.start + most_stops);
    out.count = std::max(2, static_cast<int>(std::ceil(out.stop - out.start)));
    return out;
}

std::vector<float> hdr_flip_map(const Image& reference, const Image& test, const PixelMask& usable,
                                const FlipExposures& exposures) {
    std::vector<FlipDisplay> displays;
    const double step = exposures.count > 1 ? (exposures.stop - exposures.start) / (exposures.count - 1) : 0;
    // HDR-FLIP compares the images at `count` exposures from `start` to `stop`. If `start` equals `stop`, all
    // of them are the same, so one comparison is enough.
    const int different = step > 0 ? exposures.count : 1;
    displays.reserve(static_cast<std::size_t>(different));
    for (int i = 0; i < different; ++i)
        displays.push_back(FlipDisplay::at_exposure(exposures.start + i * step));
    std::vector<float> map;
    flip_errors(reference, test, usable, displays, map);
    return map;
}

}  // namespace postlens
