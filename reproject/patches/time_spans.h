// Groups views by time, so that bounds of the positions of moving surfaces can be computed quickly.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The earliest and the latest view within a time span of 1/64 of the exposure. They are the same view if the
/// span contains only one. In the other views of the span, a moving surface lies near the line between its
/// positions in these two views. Even on a curved path, its distance from this line is less than the distance
/// between the two positions.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Returns the time spans of all views that use the records of `instant` and have motions. Views of sets
/// without rays do not store their instant, so each of these views gets a span of its own. The result points
/// into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
