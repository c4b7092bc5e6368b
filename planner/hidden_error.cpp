#include "planner/hidden_error.h"

#include <algorithm>
#include <cmath>

#include "focus/depth_levels.h"
#include "records/srgb.h"

namespace postlens {
namespace {

/// Of what mirrors and glass show the rest is an upper bound: where it was most of what a tile expects, nine
/// in ten of the calibrating tiles came to 0.38 of it.
constexpr double seen_below = 0.5;
constexpr double all_unknown = 0.999;
/// Of two values, the square of their difference over the variance of as many of each.
constexpr double two_levels = 4;
/// The same of two that have nothing to do with each other, as what the pinhole saw in the place of what no
/// view knows.
constexpr double any_two = 2;

float brightest(const float* rgb) {
    return std::max({rgb[0], rgb[1], rgb[2]});
}

}  // namespace

HiddenError::HiddenError(const Image& image, const MisplacedLight& misplaced, double apart_px)
    : image_(image),
      misplaced_(misplaced.picture()),
      moved_px_(misplaced.moved_px()),
      contrasts_(image),
      apart_px_(apart_px) {}

HiddenError::Shares HiddenError::shares(const FieldFocus& of, std::size_t k) {
    return {static_cast<double>(of.unknown[k]), static_cast<double>(of.unknown_below[k]),
            static_cast<double>(of.guessed_below[k])};
}

double HiddenError::at(std::size_t k, const Shares& shares) {
    // Who looks past what hides a surface and finds nothing known is given what hides it: the two differ as
    // much as what lies side by side there. In mirrors and glass it is given what the others see of the same,
    // a little farther on. What none knows is filled in from wherever something is known.
    const auto filled_in = [&](double share, double from_px) {
        const double px = share < all_unknown ? from_px : Contrasts::largest_px;
        return share > 0 ? filled_in_error(share, contrasts_.at(k, px)) : 0;
    };
    double below = filled_in(shares.unknown_below, apart_px_);
    if (!misplaced_.empty() && misplaced_[k] > 0) {
        const auto lost = static_cast<double>(srgb_from_linear(misplaced_[k])),
                   all = static_cast<double>(srgb_from_linear(brightest(image_.rgb.data() + 3 * k)));
        const double share = lost < all ? lost / all : 1;
        below += share * share * contrasts_.at(k, static_cast<double>(moved_px_[k] / misplaced_[k]));
    }
    const double guessed = any_two * filled_in(shares.guessed_below, 2 * apart_px_);
    return std::max({two_levels * filled_in(shares.unknown, 2 * apart_px_), seen_below * below, guessed});
}

double apart_px(const SampleFileReader& file, const FocusGeometry& geometry, bool with_shutter) {
    return with_shutter ? Contrasts::largest_px : largest_coc_px(depth_range(file), geometry) / 2;
}

double noise_of_rays(const Image& image, std::size_t k, float light_square, int rays) {
    // A deviation above and below: what is white already gets no brighter, but may be missed.
    const float light = brightest(image.rgb.data() + 3 * k),
                deviation = std::sqrt(light_square / static_cast<float>(rays)), is = srgb_from_linear(light);
    const auto above = static_cast<double>(srgb_from_linear(light + deviation) - is),
               below = static_cast<double>(srgb_from_linear(std::max(0.0F, light - deviation)) - is);
    return (above * above + below * below) / 2;
}

}  // namespace postlens
