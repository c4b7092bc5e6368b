// Computes the residuals of a lens fit, i.e. the differences between a given image and the image that the
// command `focus` makes with a lens. Also computes how these residuals change with the aperture and the focus
// distance (derivatives), which the fit needs.
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

/// Residuals of a lens fit, i.e. the differences between a computed image and the given image, one for each
/// selected pixel. The images are compared by `picture_tone`, a logarithmic brightness. Residuals above
/// `linear_from` count linearly instead of quadratically (Huber loss).
class PictureResiduals {
  public:
    /// Prepares the comparison of the given image `picture` with images for various lenses, which are made
    /// from the sample file `file`. `impulse` states how a lens distributes the light of a point.
    /// `expected_pictures`, the estimated number of images, is needed for the progress display. `file` must
    /// outlive this object.
    PictureResiduals(const SampleFileReader& file, const Image& picture, const Impulse& impulse,
                     std::uint64_t expected_pictures);

    /// Selects the pixels in which the computed images are compared with the given image. `pixels` has one
    /// entry per pixel, 0 for unused pixels.
    void use(const std::vector<char>& pixels);
    /// Number of residuals (differences between the images), one per selected pixel.
    [[nodiscard]] std::size_t size() const { return used_.size(); }
    [[nodiscard]] int pictures() const { return pictures_; }

    /// Makes the image for the lens `place`, i.e. for its aperture and focus distance. Writes to `out` the
    /// residuals of this image: for each selected pixel, the difference between its logarithmic brightness
    /// and that of the given image. Differences above `linear_from` count linearly (Huber loss).
    void at(const LensPlace& place, double* out, double linear_from);
    /// Writes to `out` two derivatives of the residual of each pixel (see `at`): with respect to the
    /// logarithm of the aperture, and to the inverse focus distance. They are differences between images for
    /// slightly changed lenses. `focus_step_per_m` is the change of the inverse focus distance, in 1/m.
    void derivatives(const LensPlace& place, double focus_step_per_m, double linear_from, double* out);
    /// These two functions write to `out` the residuals of an image: its differences from the given picture
    /// in the selected pixels. The function `of` uses the image `image`. The function `of_even` uses an image
    /// of uniform brightness, the median of the given picture, so its residuals measure the contrast of this
    /// picture.
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
    /// Cache of the images that the lens fit computed last, because it often needs the same image again. Each
    /// entry contains the lens (aperture and focus distance) and the image's tones, i.e. the logarithmic
    /// brightness of each pixel. The newest entry is the last.
    std::deque<std::pair<LensPlace, Tones>> focused_;
    Tones wanted_;
    std::vector<std::size_t> used_;
    int pictures_ = 0;
    Progress progress_;
};

}  // namespace postlens
