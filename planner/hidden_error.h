// How far off a pixel is for light that no record shows or that W misplaces, and how noisy rays would be in
// its place.
#pragma once

#include <vector>

#include "focus/bend_warning.h"
#include "focus/field_focus.h"
#include "planner/local_contrast.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Expected squared errors of a picture's pixels, encoded values, means of the channels.
class HiddenError {
  public:
    /// `apart_px`: how far views look past each other. Keeps a reference to `image`, scene-linear.
    HiddenError(const Image& image, const MisplacedLight& misplaced, double apart_px);
    /// Of a pixel, as FieldFocus has them.
    struct Shares {
        double unknown = 0, unknown_below = 0, guessed_below = 0;
    };
    [[nodiscard]] static Shares shares(const FieldFocus& of, std::size_t k);
    /// Of pixel k. Not for several threads at once.
    [[nodiscard]] double at(std::size_t k, const Shares& shares);

  private:
    const Image& image_;
    std::vector<float> misplaced_, moved_px_;
    Contrasts contrasts_;
    double apart_px_;
};

/// By the widest circle of confusion; with a shutter by as much as Contrasts know.
[[nodiscard]] double apart_px(const SampleFileReader& file, const FocusGeometry& geometry, bool with_shutter);

/// What highlights that a lens spreads add to the squared error, encoded, of so many rays through pixel k:
/// few of many meet them, and are too bright then. `light_square`: as FieldFocus has it.
[[nodiscard]] double noise_of_rays(const Image& image, std::size_t k, float light_square, int rays);

}  // namespace postlens
