// Images from records that are traced again, each time with one limit of the records removed.
#pragma once

#include <vector>

#include "focus/field_focus.h"
#include "planner/error_causes.h"
#include "records/image.h"

namespace postlens {

struct ErrorTrial {
    ErrorCause cause;      ///< cause that the trial removes
    Image image;           ///< light field of the new records, in the window of the file
    bool decides = false;  ///< later trials remove more; they are not used for pixels that this one corrects
    bool other_instants = false;  ///< whether the trial adds recorded instants
};

/// Traces the file's scene as the file was traced, but with enough overscan for lens and shutter
/// (frame_edge); with all hidden surfaces and, with a shutter, as many instants as the motion needs
/// (hidden_surface); and with one level more, full shading trees and a search for narrow objects
/// (record_density). The file must have been traced from `scene`. Throws what tracing and field_focus throw.
[[nodiscard]] std::vector<ErrorTrial> error_trials(const SampleHeader& header, const Scene& scene,
                                                   const HybridSettings& view,
                                                   const FieldFocusSettings& by_field);

}  // namespace postlens
