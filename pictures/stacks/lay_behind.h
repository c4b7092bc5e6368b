// Adds a second image of the same camera behind a first one. The second image shows surfaces that were hidden
// when the first was rendered.
#pragma once

#include <string>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Result of `lay_behind`.
struct LaidBehind {
    std::size_t samples = 0;  ///< samples that were added
    double nearer_share = 0;  ///< share of the back image's pixels with an omitted, nearer sample
};

/// Adds the samples of `back` to the stacks (the samples of one pixel) of `front`. Both images must show the
/// same view. They may store different pixels. The result stores the pixels of both, except on sides where
/// `front` ends at the border of the raster or beyond: there it stores those of `front` alone.
///
/// At each pixel, the samples of both images are sorted by depth, as in a single deep image. Samples of
/// `back` are used only if they are behind the last opaque sample of `front`, and if `front` has no sample at
/// their depth, which would be the same surface. So an opaque `front` looks the same as before when
/// flattened. The names of the Cryptomatte of `back` are added to those of `front`. `nearer_share` counts the
/// pixels where a sample of `back` is nearer by more than a twentieth of its distance. A large share means
/// that the images are in the wrong order or that their depths do not agree.
///
/// Neither image may have mixed pixels (call `unmix_edges` first). Throws Error(invalid_input), with `name`
/// as the name of `back`, if the rasters or the cameras differ, and Error(out_of_memory).
LaidBehind lay_behind(ForeignPicture& front, const ForeignPicture& back, const std::string& name);

}  // namespace postlens
