// Groups views (images for one lens point and instant) into short time spans. The positions of moving
// surfaces are bounded by the first and last view of each span, which is faster than testing all views.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// First and last view (image for one lens point and instant) of one time span: 1/64 of the exposure.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Finds the views that show moving objects and are reprojected from the recorded instant `instant`. Groups
/// these views by time. The result points into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
