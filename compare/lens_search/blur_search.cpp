#include "compare/lens_search/blur_search.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "compare/lens_search/picture_tone.h"
#include "core/threads.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr int widest_px = 256;
constexpr int aperture_steps = 48, focus_steps = 81;
constexpr double narrowest_coc_px = 0.7;
/// The tested blur diameters increase in steps of 0.5 px up to 8 px. Above 8 px, each is 1/16 larger than the
/// one before.
constexpr double step_px = 0.5, even_to_px = 8;
/// Largest number of pixels on which the search compares an image of each tested lens with the given image.
/// More pixels would not help, because apertures are tested only in steps of about 10 %, which limits the
/// accuracy of the result.
constexpr std::size_t most_pixels = 12000;
/// Limit of the Huber loss, by which the search compares the image of a lens with the given image. Larger
/// differences count linearly instead of quadratically. The images of the search are only approximate, and
/// beside depth edges, they are wrong by about this value.
constexpr double linear_from = 0.1;

/// Luminances and inverse depths (1/m) of a downscaled image: means of `factor` x `factor` pixels.
struct Reduced {
    cv::Mat pinhole, picture, inverse_depth;
};

Reduced reduce(const Image& pinhole, const Image& picture, const RecordedDepths& depths, int factor) {
    const int width = depths.width / factor, height = depths.height / factor;
    Reduced out{cv::Mat(height, width, CV_32F), cv::Mat(height, width, CV_32F),
                cv::Mat(height, width, CV_32F)};
    const double share = 1.0 / (factor * factor);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double before = 0, after = 0, inverse = 0;
            for (int i = 0; i < factor * factor; ++i) {
                const int px = x * factor + i % factor, py = y * factor + i / factor;
                const auto k = static_cast<std::size_t>(py) * static_cast<std::size_t>(depths.width) +
                               static_cast<std::size_t>(px);
                before += exact_luminance(pinhole.pixel(px, py));
                after += exact_luminance(picture.pixel(px, py));
                inverse += static_cast<double>(depths.nearest_per_m[k] + depths.farthest_per_m[k]) / 2;
            }
            out.pinhole.at<float>(y, x) = static_cast<float>(before * share);
            out.picture.at<float>(y, x) = static_cast<float>(after * share);
            out.inverse_depth.at<float>(y, x) = static_cast<float>(inverse * share);
        }
    }
    return out;
}

/// Returns a uniform disc as a blur kernel whose weights sum to 1. Each pixel's weight is the fraction of its
/// 8 x 8 sample points that lie inside the disc.
cv::Mat disc(double diameter_px) {
    const int reach = static_cast<int>(std::ceil(diameter_px / 2));
    cv::Mat out = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_32F);
    constexpr int points = 8;
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            int inside = 0;
            for (int i = 0; i < points * points; ++i) {
                const int row = i / points;
                const double dx = x + (i % points + 0.5) / points - 0.5;
                const double dy = y + (row + 0.5) / points - 0.5;
                inside += std::hypot(dx, dy) <= diameter_px / 2 ? 1 : 0;
            }
            out.at<float>(y + reach, x + reach) = static_cast<float>(inside);
        }
    }
    const double sum = cv::sum(out)[0];
    if (sum == 0) out.at<float>(reach, reach) = 1;
    return sum > 0 ? cv::Mat(out / sum) : out;
}

std::vector<double> diameters_up_to(double largest_px) {
    std::vector<double> out{0};
    while (out.back() < largest_px)
        out.push_back(out.back() < even_to_px ? out.back() + step_px
                                              : out.back() * (1 + step_px / even_to_px));
    return out;
}

/// Finds the error of any lens quickly. A table holds the error of every compared pixel for several blur
/// diameters. A lens gives each pixel one of these diameters, so the error of the lens is found by one
/// look-up per pixel.
class RoughModel {
  public:
    RoughModel(const Reduced& reduced, double largest_px) : diameters_px_(diameters_up_to(largest_px)) {
        const std::size_t pixels = reduced.pinhole.total();
        const std::size_t stride = (pixels + most_pixels - 1) / most_pixels;
        for (std::size_t k = 0; k < pixels; k += stride)
            inverse_depth_per_m_.push_back(reduced.inverse_depth.ptr<float>()[k]);
        const std::size_t levels = diameters_px_.size();
        squares_.resize(inverse_depth_per_m_.size() * levels);
        parallel_for(levels, [&](std::size_t level) {
            cv::Mat blurred;
            if (level == 0) {
                blurred = reduced.pinhole;
            } else {
                cv::filter2D(reduced.pinhole, blurred, CV_32F, disc(diameters_px_[level]), {-1, -1}, 0,
                             cv::BORDER_REFLECT);
            }
            for (std::size_t i = 0; i < inverse_depth_per_m_.size(); ++i) {
                const double have = picture_tone(static_cast<double>(blurred.ptr<float>()[i * stride]));
                const double want =
                    picture_tone(static_cast<double>(reduced.picture.ptr<float>()[i * stride]));
                const double r = robust(have - want, linear_from);
                squares_[i * levels + level] = static_cast<float>(r * r);
            }
        });
    }

    /// Returns the RMS difference between the given image and the pinhole image blurred by a lens. At inverse
    /// depth d, the lens blurs with a disc of diameter gain_px * |d - inverse_focus_per_m|.
    [[nodiscard]] double error(double gain_px, double inverse_focus_per_m) const {
        const std::size_t levels = diameters_px_.size();
        double sum = 0;
        for (std::size_t i = 0; i < inverse_depth_per_m_.size(); ++i) {
            const double coc_px =
                gain_px * std::abs(inverse_focus_per_m - static_cast<double>(inverse_depth_per_m_[i]));
            sum += static_cast<double>(squares_[i * levels + level_of(coc_px)]);
        }
        return std::sqrt(sum / static_cast<double>(inverse_depth_per_m_.size()));
    }

  private:
    [[nodiscard]] std::size_t level_of(double coc_px) const {
        const double even = even_to_px / step_px;
        const double level = coc_px < even_to_px
                                 ? coc_px / step_px
                                 : even + std::log(coc_px / even_to_px) / std::log1p(step_px / even_to_px);
        return std::min(static_cast<std::size_t>(std::lround(level)), diameters_px_.size() - 1);
    }
    std::vector<double> diameters_px_;
    std::vector<float> inverse_depth_per_m_, squares_;
};

}  // namespace

std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture, const RecordedDepths& depths,
                                    const SampleHeader& header) {
    const int factor = std::max(1, std::min((depths.width + widest_px - 1) / widest_px, depths.height));
    const Reduced reduced = reduce(pinhole, picture, depths, factor);
    const double largest_px = std::max(8.0, reduced.pinhole.cols / 4.0);
    const RoughModel model(reduced, largest_px);

    const double nearest = depths.nearest(), farthest = depths.farthest();
    const double span = std::max(nearest - farthest, 0.1 * nearest);
    const double gain_px = header.film_distance_mm / header.pixel_pitch_mm / factor;
    // `first_focus` and `last_focus` are the limits of the tested focus distances, stored as inverse
    // distances in 1/m. The scene's inverse depths extend from `farthest` to `nearest`, a range of length
    // `span`. The tested range extends beyond it by span / 2 at both ends, but not below 0 (infinity).
    const double first_focus = std::max(0.0, farthest - span / 2), last_focus = nearest + span / 2;
    // Returns the lens of the search grid with the aperture number i and the focus number k. If the nearest
    // depth is in focus, the smallest aperture blurs the farthest depth by 0.7 px, and the largest aperture
    // blurs it by a quarter of the image width.
    const auto place = [&](int i, int k) {
        const double coc_px = narrowest_coc_px * std::pow(largest_px / narrowest_coc_px,
                                                          static_cast<double>(i) / (aperture_steps - 1));
        return LensPlace{1000 * coc_px / (gain_px * span),
                         first_focus + (last_focus - first_focus) * k / (focus_steps - 1)};
    };
    std::vector<double> errors(static_cast<std::size_t>(aperture_steps) * focus_steps);
    parallel_for(errors.size(), [&](std::size_t n) {
        const int index = static_cast<int>(n);
        const LensPlace p = place(index / focus_steps, index % focus_steps);
        errors[n] = model.error(gain_px * p.aperture_mm / 1000, p.inverse_focus_per_m);
    });
    std::vector<RoughMatch> out;
    for (int i = 0; i < aperture_steps; ++i) {
        for (int k = 0; k < focus_steps; ++k) {
            const auto at = [&](int a, int b) {
                return errors[static_cast<std::size_t>(a) * focus_steps + static_cast<std::size_t>(b)];
            };
            bool least = true;
            for (int a = std::max(0, i - 1); a <= std::min(aperture_steps - 1, i + 1); ++a) {
                for (int b = std::max(0, k - 1); b <= std::min(focus_steps - 1, k + 1); ++b) {
                    // A lens of the search grid, with the indices i (aperture) and k (focus), is a local
                    // minimum if none of its neighbours (a, b) has a smaller error. Among neighbours with
                    // equal errors, only the first in the grid is a minimum.
                    const bool before = a < i || (a == i && b < k);
                    least = least && (before ? at(i, k) < at(a, b) : at(i, k) <= at(a, b));
                }
            }
            if (least) out.push_back({place(i, k), at(i, k)});
        }
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const RoughMatch& a, const RoughMatch& b) { return a.error < b.error; });
    return out;
}

}  // namespace postlens
