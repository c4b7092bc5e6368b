// Reads apertures from image files.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// Makes an aperture from `impulse`: a disc, a polygon or an image. The Rec.709 luminance of the image,
/// downscaled to at most 512 px, becomes the transmittance. Throws Error(invalid_input) if the image cannot
/// be read or transmits no light. Throws Error(wrong_arguments) if `impulse` describes no aperture or has a
/// value out of range.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
