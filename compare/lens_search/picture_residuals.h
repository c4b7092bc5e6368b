// Computes the differences between a given image and the image that `focus` makes with a lens. Also computes
// their derivatives with respect to aperture and focus distance.
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
    /// Compares `picture` with images made from `file`, to which it keeps a reference. `expected_pictures`,
    /// the number of images to compute, is for the progress display.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Selects the pixels to compare. `pixels` has one entry per pixel, 0 for unused pixels.
    void use(const std::vector<char>& pixels);
    /// Number of residuals (differences between the images), one per selected pixel.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Writes the differences between the image that the lens `place` makes and the image to be fitted.
    /// Differences above `linear_from` count linearly (Huber loss).
    void at(const LensPlace& place, double* out, double linear_from);
    /// Writes the derivatives of each pixel's difference with respect to the aperture's logarithm and the
    /// inverse focus distance. The inverse focus distance is changed by `focus_step_per_m` to either side.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// `of` writes the differences between `image` and the image to be fitted. `of_even` does so for a
    /// uniform image of the fitted image's median brightness.
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
    /// Cache of the computed images of lenses, newest last. The solver often evaluates the same lens again.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
