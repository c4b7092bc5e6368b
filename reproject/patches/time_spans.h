// Groups views (images for one lens point and instant) into short time spans, to quickly bound where moving
// surfaces are seen.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The first and last view (image for one lens point and instant) in a span of 1/64 of the exposure. In
/// between, moving surfaces are assumed to stray from a straight line by less than the line's length.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Groups the views that show motion and use the records of `instant` into short time spans. Without rays,
/// each view is a span of its own, because its PatchView::light_before need not be set. The result points
/// into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
