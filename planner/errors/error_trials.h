// Finds the causes of errors by trials. Each trial traces the scene again with settings that remove one cause
// of error, for example missing hidden surfaces, and makes an image from this trace. If a pixel's error is
// much smaller in this image, the cause is found.
#pragma once

#include <vector>

#include "focus/light_field/field_focus.h"
#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

struct ErrorTrial {
    ErrorCause cause = ErrorCause::none;  ///< cause of error that the trial removes
    Image image;  ///< light field of the new records, of the same size as the file's image
    /// Whether this trial can end the search for the cause of a pixel's error. The trials are tested in
    /// order. A trial is successful if its image lacks most of the pixel's error. Then, if `decides` is true,
    /// `cause` is accepted, and no later trial is tested for this pixel.
    bool decides = false;
    bool other_instants = false;  ///< whether the trial adds recorded instants
};

/// Traces the scene of a sample file again, in several trials with better settings. The name of a trial is
/// the cause of error that it removes:
/// - frame_edge: enough pixels are traced around the image (overscan) for the lens and the shutter
/// - hidden_surface: all hidden surfaces are recorded and, with a shutter, enough instants
/// - record_density: one more level of subdivision (3 to 6 in all), more reflections and refractions, and a
///   search for narrow objects
///
/// The file must have been traced from `scene`. Throws the errors of tracing and of field_focus.
[[nodiscard]] std::vector<ErrorTrial> error_trials(const SampleHeader& header, const Scene& scene,
                                                   const HybridSettings& view,
                                                   const FieldFocusSettings& by_field);

}  // namespace postlens
