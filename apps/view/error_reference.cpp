#include "apps/view/error_reference.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/threads.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

/// Intended duration of tracing the reference, in seconds.
constexpr double wanted_seconds = 10;
constexpr int pilot_spp = 4, least_spp = 32, most_spp = 1024;
/// Radius, in px, within which the noise of the reference is averaged. The noise of each pixel is estimated
/// from two images, each made from half of the samples. For a single pixel, this estimate is inaccurate, so
/// it is averaged over the neighbouring pixels.
constexpr int noise_radius_px = 2;
constexpr float tolerated_deviations = 3;

/// Returns the variance of the noise of each pixel, in sRGB values, as the mean of the three channels. `made`
/// contains two images, each made from half of the samples. Because their noise is independent, the variance
/// is estimated from their difference.
std::vector<float> variances(const HalvedImage& made) {
    std::vector<float> out(made.image.rgb.size() / 3);
    parallel_for(
        out.size(),
        [&](std::size_t k) {
            for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
                const float d =
                    srgb_from_linear(made.first_half.rgb[c]) - srgb_from_linear(made.second_half.rgb[c]);
                out[k] += d * d / 12;
            }
        },
        1U << 12U);
    return out;
}

std::vector<float> local_deviations(const std::vector<float>& variance, int width, int height) {
    std::vector<float> out(variance.size());
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < width; ++x) {
            float sum = 0;
            int count = 0;
            for (int v = std::max(0, y - noise_radius_px); v <= std::min(height - 1, y + noise_radius_px);
                 ++v) {
                for (int u = std::max(0, x - noise_radius_px); u <= std::min(width - 1, x + noise_radius_px);
                     ++u, ++count) {
                    sum += variance[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                                    static_cast<std::size_t>(u)];
                }
            }
            out[row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                std::sqrt(sum / static_cast<float>(count));
        }
    });
    return out;
}

}  // namespace

ErrorReference trace_error_reference(const std::function<HalvedImage(int spp)>& trace) {
    const double pilot_seconds = std::max(trace(pilot_spp).seconds, 1e-6);
    const double spp =
        std::clamp(pilot_spp * wanted_seconds / pilot_seconds, double{least_spp}, double{most_spp});
    ErrorReference out;
    out.spp = 2 * static_cast<int>(spp / 2);
    HalvedImage made = trace(out.spp);
    out.noise = local_deviations(variances(made), made.image.width, made.image.height);
    out.image = std::move(made.image);
    return out;
}

void take_out_noise(ErrorReference& reference, const Image& image) {
    Image& of = reference.image;
    if (of.width != image.width || of.height != image.height) {
        fail(ExitCode::invalid_input,
             "the picture has another size than the rays (got {}x{}; expected {}x{})", image.width,
             image.height, of.width, of.height);
    }
    for (std::size_t k = 0; k < reference.noise.size(); ++k) {
        bool within = true;
        for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
            const float d = std::abs(srgb_from_linear(image.rgb[c]) - srgb_from_linear(of.rgb[c]));
            within = within && d <= tolerated_deviations * reference.noise[k];
        }
        if (within) std::copy_n(&image.rgb[3 * k], 3, &of.rgb[3 * k]);
    }
}

}  // namespace postlens
