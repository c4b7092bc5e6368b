// Reads apertures from image files.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// Makes an aperture: a disc, a polygon or an image. An image wider or higher than 512 px is downscaled, and
/// its Rec.709 luminance becomes the transmittance of the aperture. Throws Error(invalid_input) if the image
/// cannot be read or transmits no light. Throws Error(wrong_arguments) if a setting is out of range, or if
/// `impulse` describes diffraction or a real lens instead of an aperture.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
