// Residuals per pixel between `focus` through a lens and an image, with their derivatives by the lens.
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
    /// Keeps a reference to `file`. Progress counts the images that `focus` makes, up to `expected_pictures`.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Selects the pixels that all further residuals use. `pixels` has one entry per pixel of the image, 0
    /// for unused ones.
    void use(const std::vector<char>& pixels);
    /// Number of residuals, one per selected pixel.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Robust residuals of `focus` through a lens; above `linear_from` they count linearly.
    void at(const LensPlace& place, double* out, double linear_from);
    /// Derivatives of the residuals by the logarithm of the aperture and by 1/s (1/m) for the focus distance
    /// s, interleaved. `focus_step_per_m`: half the difference in 1/s over which they are taken.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// The robust residuals of any image, and of a constant image of the median tone, instead of `focus`.
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
    /// Cache of focused images, newest last. The solver returns to lenses that it has evaluated before.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
