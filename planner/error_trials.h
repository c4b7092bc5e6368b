// What a picture would be without one shortcoming of its records: traced again, each time with that one taken
// away.
#pragma once

#include <vector>

#include "focus/field_focus.h"
#include "planner/error_causes.h"
#include "records/image.h"

namespace postlens {

struct ErrorTrial {
    ErrorCause cause;      ///< that is taken away
    Image image;           ///< by light field, of the window that the file has
    bool decides = false;  ///< those that follow take more away, and say nothing new where this one is right
    bool other_instants = false;  ///< what it adds are instants
};

/// The file's scene traced as the file was, but wide enough for lens and shutter (frame_edge), with
/// everything that is hidden and, with a shutter, as many instants as its motion asks for (hidden_surface),
/// or one level finer, with whole shading trees and narrow things looked for (record_density). `scene` must
/// be the file's own. Throws what tracing and field_focus throw.
[[nodiscard]] std::vector<ErrorTrial> error_trials(const SampleHeader& header, const Scene& scene,
                                                   const HybridSettings& view,
                                                   const FieldFocusSettings& by_field);

}  // namespace postlens
