// Depths of the surfaces at the border of the traced area. They determine how much overscan (pixels traced
// outside the image) a lens needs.
#pragma once

#include <cmath>
#include <vector>

#include "focus/scatter/border_radii.h"
#include "lens/focus_geometry.h"
#include "records/record.h"

namespace postlens {

/// The depths of the surfaces along the border of the traced area. For each pixel corner at this border, the
/// nearest and the farthest depth are kept, because the blur there is largest at one of them. Only surfaces
/// that the pinhole sees directly count.
class BorderDepths {
  public:
    /// `source` is the window of the recorded pixel corners.
    explicit BorderDepths(const RasterWindow& source);
    /// Adds the border's depths in the pixel rows [y_begin, y_end). `band` must contain these rows.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns the largest blur radius of the surfaces at each pixel corner along the border of the traced
    /// area, in px.
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
