// Depths at the border of the records. They determine how much overscan a lens needs.
#pragma once

#include <cmath>
#include <vector>

#include "focus/scatter/border_radii.h"
#include "lens/focus_geometry.h"
#include "records/record.h"

namespace postlens {

/// The range of depths at the border of the records, as the inverse depth 1/z'. There is one range for each
/// pixel corner of the outermost recorded rows and columns. Only surfaces that are seen directly count.
class BorderDepths {
  public:
    /// `source` is the window of the recorded pixel corners.
    explicit BorderDepths(const RasterWindow& source);
    /// Adds the records of rows [y_begin, y_end) of `band`.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns how far, in px, the lens spreads the light of the surfaces at the border.
    [[nodiscard]] BorderRadii radii(const FocusGeometry& geometry, const ResponseModel& response) const;

  private:
    /// Range of inverse depth, in 1/m. If `farthest` exceeds `nearest`, no surface has been seen.
    struct Range {
        float nearest = 0, farthest = HUGE_VALF;
    };
    void add_corner(const RecordBand& band, int x, int y);

    RasterWindow source_;
    std::vector<Range> top_, bottom_, left_, right_;
};

}  // namespace postlens
