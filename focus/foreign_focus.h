// The focus processor for images of other programs. Each pixel is a stack of samples with depths.
#pragma once

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Computes the image that a lens forms, with `pinhole`, `scatter`, `layers` or `lightfield`. If any sample
/// is transparent, the result has alpha and premultiplied colours.
///
/// A pixel shared by several objects keeps its mixed colour, unless `unmix_edges` has separated them. The
/// result is bit-identical for any number of threads. Throws Error(wrong_arguments) if a setting is out of
/// range or another method is chosen.
[[nodiscard]] FocusResult focus_foreign(const ForeignPicture& picture, const FocusSettings& asked);

/// Returns the impulse response for pixels that are `pixel_aspect` times as wide as tall, in pixel heights.
/// Throws Error(wrong_arguments) for diffraction or a lens prescription if pixels are not square.
[[nodiscard]] Impulse impulse_in_px(const Impulse& impulse, double pixel_aspect);

}  // namespace postlens
