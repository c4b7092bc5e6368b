// Reads apertures from image files.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// Makes the aperture of an impulse response. The kind `picture` reads an image file and takes its Rec.709
/// luminance; images of more than 512 px in width or height are averaged down. Throws Error(invalid_input)
/// for an image that cannot be read or that transmits nothing, Error(wrong_arguments) for settings out of
/// range and for kinds that have no aperture.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
