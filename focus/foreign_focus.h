// Computes the image that a lens forms from another program's image. Each pixel has one or more samples with
// depths, one behind another.
#pragma once

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Computes the image that a lens forms of an image from another program with depths. The method is
/// `pinhole`, `scatter`, `layers` or `lightfield`. If the result is translucent, it has alpha and
/// premultiplied colours.
///
/// A pixel that several objects share keeps their mixed colour, unless `unmix_edges` was called before to
/// separate them. The result is bit-identical for any number of threads. Throws Error(wrong_arguments) if a
/// setting is out of range or if the method is none of these four.
[[nodiscard]] FocusResult focus_foreign(const ForeignPicture& picture, const FocusSettings& asked);

/// Converts an impulse response (the image of a point) for an image whose pixels are `pixel_aspect` times as
/// wide as tall. The result has widths in units of the pixel width, and heights in units of the pixel height.
/// Throws Error(wrong_arguments) for diffraction or a lens prescription if pixels are not square.
[[nodiscard]] Impulse impulse_in_px(const Impulse& impulse, double pixel_aspect);

}  // namespace postlens
