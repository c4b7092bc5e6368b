// The focus processor for pictures of other programs: stacks of samples that lie over each other.
#pragma once

#include "focus/focus.h"
#include "records/foreign_picture.h"

namespace postlens {

/// The picture that a lens would have taken, by `pinhole`, `scatter` or `layers` (docs/inputs.md): the same
/// responses, accumulators and visibility as of sample files, fed with the middles of pixels. Where anything
/// is transparent the result has an alpha and premultiplied colours. Deterministic: the same bits for any
/// number of threads. Edges that a Cryptomatte knows the shares of are mixed unless `unmix_edges` has taken
/// them apart before. Throws Error(wrong_arguments) for settings out of range and for other methods.
[[nodiscard]] FocusResult focus_foreign(const ForeignPicture& picture, const FocusSettings& settings);

}  // namespace postlens
