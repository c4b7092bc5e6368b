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

/// Residuals of a lens fit: differences between a computed image and the given image, one per selected pixel.
/// The images are compared by `picture_tone`, a logarithmic brightness. Differences above `linear_from` count
/// linearly (Huber loss).
class PictureResiduals {
  public:
    /// Compares `picture` with images made from `file`, which must outlive this object. `expected_pictures`
    /// is the number of images to be computed, for the progress display.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Selects the pixels to compare. `pixels` has one entry per pixel, 0 for unused pixels.
    void use(const std::vector<char>& pixels);
    /// Number of residuals (differences between the images), one per selected pixel.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Makes the image for the aperture and focus distance in `place`. Writes its residuals to `out`, one per
    /// selected pixel.
    void at(const LensPlace& place, double* out, double linear_from);
    /// Writes the derivatives of each pixel's residual with respect to the logarithm of the aperture and to
    /// the inverse focus distance. They are computed numerically: the inverse focus distance is changed by
    /// plus and minus `focus_step_per_m`.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// Both write the residuals between an image and the given picture. For `of`, this image is `image`. For
    /// `of_even`, it is uniform, with the picture's median brightness; these residuals measure the picture's
    /// contrast.
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
    /// Cache of the last computed images, each with its aperture and focus distance, newest last. The fit
    /// often needs an image again.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
