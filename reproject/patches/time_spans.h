// Groups views (images for one lens point and instant) by time, to quickly bound the positions of moving
// surfaces.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The first and last view within 1/64 of the exposure (the same if there is only one). Between them, a
/// moving surface is assumed to deviate from a straight line by less than the line's length.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Returns the time spans of all views with motions that use the records of `instant`. The result points into
/// `field`.
/// Without rays, each view gets its own span, because PatchView::light_before is only used with rays.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
