// Few of many views, for where things that move may be seen in any of them.
#pragma once

#include <cstddef>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// The earliest and the latest of the views that lie in a 64th of the shutter's light; the same where there
/// is one. What moves is, in every other view of that while, between where these have it, but for how much
/// its way curves meanwhile: less than it moves.
struct TimeSpanViews {
    struct ViewUse {
        const PatchView* view = nullptr;
        const PatchView::Use* use = nullptr;
    };
    ViewUse first, last;
};

/// Of all views of the field that use an instant's records and know motions; one for each view of sets that
/// have no rays, whose instants are not known. Pointers into `field`.
[[nodiscard]] std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant);

}  // namespace postlens
