// Depths of the surfaces at the border of the traced area. They determine how much overscan (pixels traced
// outside the image) a lens needs.
#pragma once

#include <cmath>
#include <vector>

#include "focus/scatter/border_radii.h"
#include "lens/focus_geometry.h"
#include "records/record.h"

namespace postlens {

/// The nearest and the farthest depth of the surfaces at each pixel corner along the border of the traced
/// area. These two depths suffice to find the largest blur at a corner, because the blur at any depth between
/// them is not larger. Only surfaces that the pinhole sees directly count.
class BorderDepths {
  public:
    /// `source` is the window of the recorded pixel corners.
    explicit BorderDepths(const RasterWindow& source);
    /// Adds the depths of surfaces along the border of the traced area, but only for the pixel rows [y_begin,
    /// y_end). `band` holds the records, and must contain these rows. Between the first and the last row of
    /// the area, only the leftmost and the rightmost pixel corners lie on the border.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns, for each pixel corner along the border of the traced area, the largest blur radius of the
    /// surfaces at this corner, in px. `geometry` has the lens and the focus. `response` tells how far the
    /// light of a point is spread for a given CoC.
    [[nodiscard]] BorderRadii radii(const FocusGeometry& geometry, const ResponseModel& response) const;

  private:
    struct Range {
        float nearest = 0, farthest = HUGE_VALF;
    };
    void add_corner(const RecordBand& band, int x, int y);

    RasterWindow source_;
    std::vector<Range> top_, bottom_, left_, right_;
};

}  // namespace postlens
