// Groups views (images for one lens point and instant) into short time spans. The positions of moving
// surfaces are bounded by the first and last view of each span, which is faster than testing all views.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The first and last view (image for one lens point and instant) in a span of 1/64 of the exposure. Between
/// them, the image of a moving surface is assumed to stay near a straight line: its distance from the line is
/// less than the line's length.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Groups those views that show moving surfaces, as recorded at `instant`, into short time spans. If no rays
/// are traced, the time of a view (PatchView::light_before) may be unset, so each view becomes a span of its
/// own. The result points into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
