// Stacks images of one camera behind each other: the second image holds surfaces that were hidden when the
// first was rendered.
#pragma once

#include <string>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Result of `lay_behind`.
struct LaidBehind {
    std::size_t samples = 0;  ///< samples that were added
    double nearer_share = 0;  ///< share of the back image's pixels with a sample that had to be left out
};

/// Adds the samples of `back` to the stacks of `front`. Both images show the same view. Their stored pixels
/// may differ; the result stores the pixels of both.
///
/// The samples of both images are sorted by depth at each pixel, as in a single deep image. Samples of `back`
/// that are not behind the last opaque sample of `front` are left out. So a pixel of `back` that shows the
/// same surface as `front` adds nothing, and the flattened image of an opaque `front` does not change.
/// `nearer_share` counts the pixels where a sample of `back` is nearer by more than a twentieth of its
/// distance. A large share shows that the images are in the wrong order or that their depths do not agree.
///
/// Both images must have no mixed pixels (`unmix_edges` first). Throws Error(invalid_input), with `name` as
/// the name of `back`, if the rasters or the cameras differ, and Error(out_of_memory).
LaidBehind lay_behind(ForeignPicture& front, const ForeignPicture& back, const std::string& name);

}  // namespace postlens
