// Adds the samples of a second image behind those of a first image from the same camera. The second image
// shows surfaces that the first one hides.
#pragma once

#include <string>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Result of `lay_behind`.
struct LaidBehind {
    std::size_t samples = 0;  ///< samples that were added
    double nearer_share = 0;  ///< fraction of the pixels of the back image; see lay_behind
};

/// Adds the samples of `back` to the stacks of `front`. A stack is the list of samples of one pixel. Both
/// images must show the same view, but may store different pixels. The result stores the pixels of both
/// images, except on sides where `front` ends at the border of the raster or beyond. On these sides, it
/// stores only the pixels of `front`.
///
/// A sample of `back` is added only if it is behind the last opaque sample of `front`, and if `front` has no
/// sample at the same depth. An opaque `front` therefore looks the same as before when it is composited. The
/// samples of a pixel are sorted by depth. If `front` is opaque at a pixel where `back` transmits light, the
/// result states that empty space lies behind the samples (ForeignPicture::ends_in_nothing). The names in the
/// Cryptomatte of `back` are added to those of `front`.
///
/// In some pixels, a sample of `back` may be omitted because it is nearer than the last opaque sample of
/// `front`. `nearer_share` is the fraction of pixels in which it is nearer by more than a twentieth of its
/// distance. If this fraction is large, the images are in the wrong order or their depths do not agree.
///
/// Neither image may have mixed pixels (call `unmix_edges` first). Throws Error(invalid_input) if the rasters
/// or the cameras differ; the message calls the back image `name`. Throws Error(out_of_memory).
LaidBehind lay_behind(ForeignPicture& front, const ForeignPicture& back, const std::string& name);

}  // namespace postlens
