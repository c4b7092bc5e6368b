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

/// Finds the views (images for one lens point and instant) that show moving objects and use the recorded
/// instant with the index `instant`. Groups those of sets with a ray tracer into short time spans. Each other
/// view is a span of its own. The result points into `field`, so `field` must outlive it.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
