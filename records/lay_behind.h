// Stacks images of one camera behind each other: what a renderer hid in one of them stands in the next.
#pragma once

#include <string>

#include "records/foreign_picture.h"

namespace postlens {

/// What `lay_behind` found.
struct LaidBehind {
    std::size_t samples = 0;  ///< samples that were added
    double nearer_share = 0;  ///< share of the back image's pixels with a sample that had to be left out
};

/// Adds the samples of `back` to the stacks of `front`. Both images show the same view; their stored pixels
/// may differ, and the result stores those of both.
///
/// At each pixel, samples of both are ordered by depth, as those of one deep image. Samples of `back` that
/// are not behind the last opaque sample of `front` are left out: a pixel at which `front` already shows what
/// `back` holds gets nothing new, so that the flattened image of an opaque `front` stays as it is.
/// `nearer_share` counts the pixels where such a sample is nearer by more than a twentieth of its distance,
/// which says that the images are in the wrong order or that their depths do not agree.
///
/// Both images must have no mixed pixels (`unmix_edges` first). Throws Error(invalid_input), with `name` as
/// the name of `back`, if the rasters or the cameras differ, and Error(out_of_memory).
LaidBehind lay_behind(ForeignPicture& front, const ForeignPicture& back, const std::string& name);

}  // namespace postlens
