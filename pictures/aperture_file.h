// Reads apertures from image files.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// Makes the aperture of an impulse response. For the kind `picture`, the aperture is read from an image
/// file. Its Rec.709 luminance is the transmittance, and images wider or higher than 512 px are downscaled.
/// Throws Error(invalid_input) for an image that cannot be read or that transmits no light. Throws
/// Error(wrong_arguments) for settings out of range and for kinds that have no aperture.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
