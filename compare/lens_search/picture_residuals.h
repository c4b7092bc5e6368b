// Computes the residuals between a given image and the image that `focus` makes with a lens, and their
// derivatives.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "compare/lens_search/blur_search.h"
#include "core/progress.h"
#include "lens/impulse.h"
#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

class PictureResiduals {
  public:
    /// Keeps a reference to `file`. `expected_pictures`, the number of images to compute, is for the progress
    /// display.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Selects the pixels to compare. `pixels` has one entry per pixel, 0 for unused pixels.
    void use(const std::vector<char>& pixels);
    /// Number of residuals (differences between the images), one per selected pixel.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Computes the image of the lens `place`, and writes its differences from the wanted image to `out`.
    /// Differences above `linear_from` count linearly instead of quadratically (robust).
    void at(const LensPlace& place, double* out, double linear_from);
    /// Writes each pixel's derivatives with respect to the logarithm of the aperture and to 1/s (s: focus
    /// distance in m). `focus_step_per_m` is half the difference step in 1/s.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// Writes the robust differences of `image` from the wanted image. `of_even` uses a constant image of the
    /// median tone.
    void of(const Image& image, double* out, double linear_from) const;
    void of_even(double* out, double linear_from) const;

    [[nodiscard]] double rms_at(const LensPlace& place, double linear_from);
    [[nodiscard]] double rms_of(const Image& image, double linear_from) const;
    [[nodiscard]] double rms_of_even(double linear_from) const;
    /// Index of the pixel to which a residual belongs.
    [[nodiscard]] std::size_t pixel(std::size_t residual) const { return used_[residual]; }

  private:
    using Tones = std::vector<float>;
    [[nodiscard]] Tones tones_of(const Image& image) const;
    [[nodiscard]] const Tones& tones_at(const LensPlace& place);
    void compare(const Tones& have, double* out, double linear_from) const;

    const SampleFileReader& file_;
    Impulse impulse_;
    /// Cache of the images computed for lenses, newest last, because the solver often returns to a lens.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
