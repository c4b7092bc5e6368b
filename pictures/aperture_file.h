// Reads apertures from image files.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// Makes an aperture: a disc, a polygon or an image. The Rec.709 luminance of the image becomes the
/// transmittance. An image above 512 px is downscaled.
/// Throws Error(invalid_input) if the image cannot be read or transmits no light. Throws
/// Error(wrong_arguments) if a setting is out of range, or describes diffraction or a real lens.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
