#include "pictures/exposure.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pictures/crop.h"

namespace postlens {
namespace {

/// exposure_warning reports that an image is too bright if more than this fraction of its pixels is brighter
/// than white.
constexpr double most_beyond_white = 0.2;
/// Smallest step of a linear 8-bit image, in which 1 is white. exposure_warning reports an image if its
/// brightest channel is above 0 but below this value.
constexpr float least_of_white = 1.0F / 255;

float largest_channel(const float* rgb) {
    return std::max({rgb[0], rgb[1], rgb[2]});
}

}  // namespace

double exposure_gain(double stops) {
    return std::exp2(stops);
}

double auto_exposure_of(std::span<double> values) {
    const auto end =
        std::partition(values.begin(), values.end(), [](double v) { return std::isfinite(v) && v > 0; });
    const auto count = static_cast<std::size_t>(end - values.begin());
    if (count == 0) return 0;
    const std::size_t rank = (95 * count + 99) / 100;  // ranks begin at 1
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(values.begin(), at, end);
    return std::clamp(-std::log2(*at), -most_exposure_stops, most_exposure_stops);
}

double auto_exposure_of(const Image& image) {
    std::vector<double> values(image.rgb.size() / 3);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<double>(largest_channel(image.rgb.data() + 3 * i));
    const double stops = image.exposure_stops.value_or(0);
    const double gain = exposure_gain(-stops);
    if (stops != 0)
        std::transform(values.begin(), values.end(), values.begin(), [&](double v) { return v * gain; });
    return auto_exposure_of(values);
}

void set_exposure(Image& image, double stops) {
    if (!image.exposure_stops || *image.exposure_stops == stops) return;
    const double gain = exposure_gain(stops - *image.exposure_stops);
    for (float& v : image.rgb) v = static_cast<float>(static_cast<double>(v) * gain);
    image.exposure_stops = stops;
}

std::optional<ExposureWarning> exposure_warning(const Image& image, const std::optional<Crop>& crop) {
    const int x0 = crop ? crop->x : 0, y0 = crop ? crop->y : 0;
    const int x1 = crop ? crop->x + crop->width : image.width,
              y1 = crop ? crop->y + crop->height : image.height;
    std::size_t beyond = 0;
    float largest = 0;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            const float v = largest_channel(image.pixel(x, y));
            beyond += v > 1 ? 1 : 0;
            largest = std::max(largest, v);
        }
    }
    const double share =
        static_cast<double>(beyond) /
        std::max<double>(1, static_cast<double>(wanted_pixels(crop, image.width, image.height)));
    const bool dark = largest > 0 && largest < least_of_white;
    if (share <= most_beyond_white && !dark) return std::nullopt;
    const double stops = auto_exposure_of(crop ? cut(image, crop) : image);
    return ExposureWarning{
        dark ? 1 : share,
        fmt::format("{} (expected --exposure {:.1f}, or --exposure auto)",
                    dark ? std::string("every pixel is darker than 1/255 of white")
                         : fmt::format("{} % of the pixels are brighter than white", rough(100 * share)),
                    stops)};
}

double stops_of_text(const std::string& text, const std::string& file) {
    double stops = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), stops);
    if (error != std::errc() || end != text.data() + text.size() ||
        !(std::abs(stops) <= most_exposure_stops)) {
        fail(ExitCode::invalid_input, "{}: {} is damaged (got {}; expected stops from {} to {})", file,
             "postlens.exposure_stops", excerpt(text), -most_exposure_stops, most_exposure_stops);
    }
    return stops;
}

}  // namespace postlens
