// Groups views into short time spans. A view is the image for one lens point and instant. Moving surfaces
// have another position in each view. To bound their positions, only the first and the last view of each span
// are tested, because testing all views would take longer.
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

/// A view is the image for one lens point and instant. Views that show moving objects are reprojected from
/// one or two recorded instants. This function finds the views that use the recorded instant with the index
/// `instant`, and groups them into short time spans. The result points into `field`, so `field` must outlive
/// it.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
