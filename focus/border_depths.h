// Depths at the border of the records. They determine how much overscan a lens needs.
#pragma once

#include <cmath>
#include <vector>

#include "focus/scatter/border_radii.h"
#include "lens/focus_geometry.h"
#include "records/record.h"

namespace postlens {

/// The range of 1/z' of the surfaces seen directly at each corner of the outermost recorded rows and columns.
class BorderDepths {
  public:
    /// `source`: the recorded corners.
    explicit BorderDepths(const RasterWindow& source);
    /// Adds the records of rows [y_begin, y_end) of `band`.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns, for a lens, the largest distances, px, at which light of the border's surfaces arrives.
    [[nodiscard]] BorderRadii radii(const FocusGeometry& geometry, const ResponseModel& response) const;

  private:
    /// 1/m; no surface has been seen if `farthest` exceeds `nearest`.
    struct Range {
        float nearest = 0, farthest = HUGE_VALF;
    };
    void add_corner(const RecordBand& band, int x, int y);

    RasterWindow source_;
    std::vector<Range> top_, bottom_, left_, right_;
};

}  // namespace postlens
