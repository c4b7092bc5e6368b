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
    /// Tells whether a success of this trial ends the search for a cause. The trials are tested in order. If
    /// this is true and the trial's image does not have the error of a pixel, `cause` is accepted, and the
    /// later trials are not tested for this pixel.
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
