// How far `focus` through a lens is from a picture, pixel by pixel, and how that changes with the lens.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "compare/blur_search.h"
#include "core/progress.h"
#include "lens/impulse.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

class PictureResiduals {
  public:
    /// Keeps references to `file`. Progress counts focused pictures, up to `expected_pictures`.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Looks at these pixels from here on, one entry for each pixel of the picture.
    void use(const std::vector<char>& pixels);
    /// Number of residuals: of pixels looked at.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Robust residuals of `focus` through a lens, beyond `linear_from` counted linearly.
    void at(const LensPlace& place, double* out, double linear_from);
    /// Derivatives by log aperture and by 1/s (m), interleaved. `focus_step_per_m`: half the difference in
    /// 1/s.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// The same residuals of any picture, and of an even one of the median tone.
    void of(const Image& image, double* out, double linear_from) const;
    void of_even(double* out, double linear_from) const;

    [[nodiscard]] double rms_at(const LensPlace& place, double linear_from);
    [[nodiscard]] double rms_of(const Image& image, double linear_from) const;
    [[nodiscard]] double rms_of_even(double linear_from) const;
    /// Index of the pixel behind a residual.
    [[nodiscard]] std::size_t pixel(std::size_t residual) const { return used_[residual]; }

  private:
    using Tones = std::vector<float>;
    [[nodiscard]] Tones tones_of(const Image& image) const;
    [[nodiscard]] const Tones& tones_at(const LensPlace& place);
    void compare(const Tones& have, double* out, double linear_from) const;

    const SampleFileReader& file_;
    Impulse impulse_;
    /// Latest last: a solver comes back to where it has been.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
