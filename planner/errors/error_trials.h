// Images from new traces of the scene. Each trace removes one limit of the recorded data, such as hidden
// surfaces.
#pragma once

#include <vector>

#include "focus/light_field/field_focus.h"
#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

struct ErrorTrial {
    ErrorCause cause;  ///< cause that the trial removes
    Image image;       ///< light field of the new records, in the window of the file
    /// If this trial corrects a pixel, later trials, which remove more limits, are not used for the pixel.
    bool decides = false;
    bool other_instants = false;  ///< whether the trial adds recorded instants
};

/// Traces the file's scene again, in several trials; each removes the limit that is one cause of error.
/// frame_edge: enough overscan for lens and shutter. hidden_surface: all hidden surfaces and, with a shutter,
/// as many instants as the motion needs. record_density: one more level of subdivision, full shading trees
/// and a search for narrow objects. The file must have been traced from `scene`. Throws what tracing and
/// field_focus throw.
[[nodiscard]] std::vector<ErrorTrial> error_trials(const SampleHeader& header, const Scene& scene,
                                                   const HybridSettings& view,
                                                   const FieldFocusSettings& by_field);

}  // namespace postlens
