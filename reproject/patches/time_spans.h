// Groups views (images for one lens point and one instant each) by time, so that bounds of the positions of
// moving surfaces can be computed quickly.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The first and the last view within 1/64 of the exposure. They are the same if there is only one view.
/// Between these two views, a moving surface may move on a curve. Its distance from the straight line between
/// its two positions is assumed to be less than the length of this line.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Returns the time spans of all views that have motions and use the records of `instant`. Without rays,
/// PatchView::light_before is not used, so each view gets a span of its own. The result points into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
