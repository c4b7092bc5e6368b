// Residuals per pixel between an image and the result of `focus` through a lens, and their derivatives with
// respect to the lens parameters.
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
    /// Keeps a reference to `file`. The progress counts the images that `focus` makes, up to
    /// `expected_pictures`.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Selects the pixels that all further residuals use. `pixels` has one entry per pixel of the image, and
    /// 0 for unused pixels.
    void use(const std::vector<char>& pixels);
    /// Number of residuals, one per selected pixel.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Makes the image that `focus` makes with the lens `place`, and writes the robust residuals between this
    /// image and the given one to `out`. Residuals above `linear_from` count linearly instead of by their
    /// square.
    void at(const LensPlace& place, double* out, double linear_from);
    /// Writes the derivatives of the residuals, alternately with respect to the logarithm of the aperture and
    /// to the inverse focus distance 1/s (1/m). `focus_step_per_m`: half the difference in 1/s over which the
    /// derivatives are taken.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// Computes the robust residuals of any image instead of a result of `focus`. The second function does so
    /// for a constant image of the median tone.
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
    /// Cache of focused images, newest last. It is useful because the solver returns to lenses that it has
    /// evaluated before.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
