#include "compare/lens_search/picture_residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "compare/lens_search/picture_tone.h"
#include "core/threads.h"
#include "focus/focus.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

/// Number of depths for which blur kernels are computed. It must be large: with few depths, a slight change
/// of the aperture or of the focus distance would change the computed image in jumps, and a fit that uses
/// derivatives would fail.
constexpr int levels = 256;
/// Fraction by which the aperture is increased and decreased for numerical derivatives of the image.
constexpr double aperture_step = 0.03;
constexpr std::size_t grain = 4096;
/// Number of computed images that the fit of a lens keeps for reuse. It suffices for two lenses. For each
/// lens, the fit needs five images: that of the lens itself, and four for numerical derivatives, with a
/// slightly larger or smaller aperture or focus distance.
constexpr std::size_t most_kept = 10;

double rms(const std::vector<double>& residuals) {
    double sum = 0;
    for (const double r : residuals) sum += r * r;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, residuals.size())));
}

}  // namespace

PictureResiduals::PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                                   std::uint64_t expected_pictures)
    : file_(file), impulse_(impulse), progress_("lens", expected_pictures) {
    wanted_ = tones_of(picture);
    used_.resize(wanted_.size());
    std::iota(used_.begin(), used_.end(), std::size_t{0});
}

void PictureResiduals::use(const std::vector<char>& pixels) {
    used_.clear();
    for (std::size_t k = 0; k < pixels.size(); ++k)
        if (pixels[k] != 0) used_.push_back(k);
}

PictureResiduals::Tones PictureResiduals::tones_of(const Image& image) const {
    Tones out(image.rgb.size() / 3);
    parallel_for(
        out.size(),
        [&](std::size_t k) {
            out[k] = static_cast<float>(picture_tone(exact_luminance(image.rgb.data() + 3 * k)));
        },
        grain);
    return out;
}

const PictureResiduals::Tones& PictureResiduals::tones_at(const LensPlace& place) {
    // Searches the images computed so far for one with the lens `place`. The apertures are compared with a
    // tolerance, because the solver that fits the lens stores the logarithm of the aperture. Converting it
    // back causes rounding errors.
    const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(a); };
    for (const auto& [at, tones] : focused_) {
        if (same(at.aperture_mm, place.aperture_mm) &&
            same(at.inverse_focus_per_m, place.inverse_focus_per_m))
            return tones;
    }
    throw_if_interrupted();
    FocusSettings s;
    // Sets the focal length (in mm) and the f-number. If the field of view is fixed, the blur depends only on
    // the diameter of the aperture, which is focal length / f-number. Therefore, every focal length gives the
    // same image if the diameter is the same.
    s.lens = {1000, 1000 / place.aperture_mm};
    s.focus_distance_m = place.inverse_focus_per_m > 0 ? 1 / place.inverse_focus_per_m
                                                       : std::numeric_limits<double>::infinity();
    s.impulse = impulse_;
    s.depths = levels;
    if (focused_.size() == most_kept) focused_.pop_front();
    focused_.emplace_back(place, tones_of(focus_picture(file_, s).image));
    ++pictures_;
    progress_.advance();
    return focused_.back().second;
}

void PictureResiduals::compare(const Tones& have, double* out, double linear_from) const {
    for (std::size_t i = 0; i < used_.size(); ++i)
        out[i] = robust(static_cast<double>(have[used_[i]] - wanted_[used_[i]]), linear_from);
}

void PictureResiduals::of(const Image& image, double* out, double linear_from) const {
    compare(tones_of(image), out, linear_from);
}

void PictureResiduals::of_even(double* out, double linear_from) const {
    std::vector<float> sorted;
    for (const std::size_t k : used_) sorted.push_back(wanted_[k]);
    if (sorted.empty()) return;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (std::size_t i = 0; i < used_.size(); ++i)
        out[i] = robust(static_cast<double>(*middle - wanted_[used_[i]]), linear_from);
}

void PictureResiduals::at(const LensPlace& place, double* out, double linear_from) {
    compare(tones_at(place), out, linear_from);
}

void PictureResiduals::derivatives(const LensPlace& place, double focus_step_per_m, double linear_from,
                                   double* out) {
    std::vector<double> less(size()), more(size());
    for (std::size_t i = 0; i < 2; ++i) {
        LensPlace low = place, high = place;
        double difference = 2 * aperture_step;
        if (i == 0) {
            low.aperture_mm *= std::exp(-aperture_step);
            high.aperture_mm *= std::exp(aperture_step);
        } else {
            low.inverse_focus_per_m = std::max(0.0, place.inverse_focus_per_m - focus_step_per_m);
            high.inverse_focus_per_m += focus_step_per_m;
            difference = high.inverse_focus_per_m - low.inverse_focus_per_m;
        }
        at(low, less.data(), linear_from);
        at(high, more.data(), linear_from);
        for (std::size_t k = 0; k < less.size(); ++k) out[2 * k + i] = (more[k] - less[k]) / difference;
    }
}

double PictureResiduals::rms_at(const LensPlace& place, double linear_from) {
    std::vector<double> r(size());
    at(place, r.data(), linear_from);
    return rms(r);
}

double PictureResiduals::rms_of(const Image& image, double linear_from) const {
    std::vector<double> r(size());
    of(image, r.data(), linear_from);
    return rms(r);
}

double PictureResiduals::rms_of_even(double linear_from) const {
    std::vector<double> r(size());
    of_even(r.data(), linear_from);
    return rms(r);
}

}  // namespace postlens
