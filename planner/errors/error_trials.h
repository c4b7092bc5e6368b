// Images from new traces of the scene. Each trace removes one limit of the recorded data, for example that
// hidden surfaces are missing.
#pragma once

#include <vector>

#include "focus/light_field/field_focus.h"
#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

struct ErrorTrial {
    ErrorCause cause;  ///< cause of error that the trial removes
    Image image;       ///< light field of the new records, with the same pixels as the file
    /// If this trial corrects a pixel, later trials are not used for this pixel. They remove further limits
    /// of the records in addition to this one, so they cannot tell which limit was the cause.
    bool decides = false;
    bool other_instants = false;  ///< whether the trial adds recorded instants
};

/// Traces the file's scene again, in several trials. Each trial removes the limit that is one cause of error:
/// - frame_edge: enough overscan for lens and shutter.
/// - hidden_surface: all hidden surfaces and, with a shutter, as many instants as the motion needs.
/// - record_density: one more level of subdivision (3 to 6 levels in total), full shading trees, and a search
///   for narrow objects.
///
/// The file must have been traced from `scene`. Throws the errors of tracing and of field_focus.
[[nodiscard]] std::vector<ErrorTrial> error_trials(const SampleHeader& header, const Scene& scene,
                                                   const HybridSettings& view,
                                                   const FieldFocusSettings& by_field);

}  // namespace postlens
