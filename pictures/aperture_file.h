// Reads apertures from image files.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// Makes an aperture of the given kind: a disc, a polygon or an image. An image is read from its file. Its
/// Rec.709 luminance becomes the transmittance, and an image of more than 512 px in width or height is
/// downscaled. Throws Error(invalid_input) if the image cannot be read or transmits no light. Throws
/// Error(wrong_arguments) if a setting is out of range, or for diffraction and real lenses, which have no
/// such aperture.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
