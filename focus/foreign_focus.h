// The focus processor for images of other programs: each pixel is a stack of samples with depths.
#pragma once

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Makes the image that a lens would take, by `pinhole`, `scatter` or `layers` (docs/inputs.md), with the
/// kernels and the compositing of sample files; a sample lies at the centre of its pixel. If any sample is
/// transparent, the result has alpha and premultiplied colours. Pixels that several objects share keep their
/// mixed colour, unless `unmix_edges` separated them by Cryptomatte before. The result is bit-identical for
/// any number of threads. Throws Error(wrong_arguments) if a setting is out of range, and for other methods.
[[nodiscard]] FocusResult focus_foreign(const ForeignPicture& picture, const FocusSettings& settings);

}  // namespace postlens
