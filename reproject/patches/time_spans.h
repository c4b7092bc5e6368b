// Groups views (images for one lens point and instant) into short spans of time. The area that a moving
// surface covers during a span is computed from the first and the last view only. A margin accounts for the
// motion in between.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// One of the 64 spans of time, with equal amounts of light, into which the exposure is divided. `first` and
/// `last` are the first and the last view in this span. They are equal if the span is a single view.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Groups views (images for one lens point and instant) into short spans of time. A view of a set without a
/// ray tracer (PatchViews::rays) is a span of its own. Only views that show moving objects and use the
/// records of the instant number `instant` are included. The result points into `field`, so `field` must
/// outlive it.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
