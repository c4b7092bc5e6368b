// Bounds of a set of views in time, to find quickly where moving surfaces may be seen.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The earliest and the latest view within a time span, 1/64 of the exposure; equal if there is only one. In
/// all other views of the span, a moving surface lies between its positions in these two views. The curvature
/// of its path moves it off that line by less than the distance of the two positions.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// The spans of all views that use the records of `instant` and have motions. Views of sets without rays have
/// no known instant, so each is a span of its own. The result has pointers into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
