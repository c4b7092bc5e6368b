// Apertures given as pictures.
#pragma once

#include "lens/aperture.h"

namespace postlens {

/// The aperture of an impulse response; of kind `picture`, from its file: Rec.709 luminance, averaged down
/// where the picture is more than 512 px wide or high. Throws Error(invalid_input) for a picture that cannot
/// be read or that lets nothing through, Error(wrong_arguments) for settings out of range and for kinds that
/// are no aperture.
[[nodiscard]] Aperture read_aperture(const Impulse& impulse);

}  // namespace postlens
