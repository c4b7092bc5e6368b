// The focus processor for images of other programs. Each pixel is a stack of samples with depths.
#pragma once

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Computes the image that a lens would form. The method is `pinhole`, `scatter`, `layers` or `lightfield`
/// (docs/inputs.md). Kernels and compositing are the same as for sample files, and each sample lies at the
/// centre of its pixel. If any sample is transparent, the result has alpha and premultiplied colours. A pixel
/// shared by several objects keeps its mixed colour, unless `unmix_edges` has already separated the objects
/// by Cryptomatte. The result is bit-identical for any number of threads. Throws Error(wrong_arguments) if a
/// setting is out of range or another method is chosen.
[[nodiscard]] FocusResult focus_foreign(const ForeignPicture& picture, const FocusSettings& asked);

/// Returns the impulse response in units of the height of a pixel. Pixels are `pixel_aspect` times as wide as
/// they are tall, so a round disc on the film covers fewer columns than rows. Throws Error(wrong_arguments)
/// if pixels are not square and the response comes from diffraction or from a lens prescription.
[[nodiscard]] Impulse impulse_in_px(const Impulse& impulse, double pixel_aspect);

}  // namespace postlens
