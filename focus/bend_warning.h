// Warning about objects in mirrors and glass that are drawn at wrong positions. The 2x2 matrix W, which
// reprojects a record to another lens point, is only a linear approximation of the true motion.
#pragma once

#include <optional>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Returns a warning of code "nonlinear", with the share of the image's pixels that show a misplaced node. A
/// node of the shading tree is misplaced if, for some lens point, it is reprojected with an error of more
/// than half a pixel. For an aperture of diameter D, this error is (film distance / pixel pitch) w_bend (D /
/// 2)^2. Only visible nodes that are brighter than 1/255 count.
///
/// Returns nothing if no pixel shows a misplaced node, if the aperture is a pinhole, or if the file has no
/// w_bend (`SampleHeader::has_bend`).
///
/// Reads the records once, unless `frame` already has their errors (FocusFrame::largest_bends). If `crop` is
/// given, only the pixels of the traced image within it count. The result does not depend on the number of
/// threads.
[[nodiscard]] std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                                       const std::optional<Crop>& crop = std::nullopt);

/// Image of the light that is reprojected to wrong positions. It contains the radiance of all records that
/// are misplaced by more than half a pixel for some lens point. The radiance of each record is spread over a
/// square as wide as the record's blur.
class MisplacedLight {
  public:
    MisplacedLight(const SampleHeader& header, const FocusGeometry& lens);
    /// Adds the records of the image rows [y_begin, y_end), which must be in `band`. The caller must add each
    /// row of the file exactly once, from top to bottom.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns, for each pixel, the radiance at wrong positions, row by row. The result is empty if there is
    /// none.
    [[nodiscard]] std::vector<float> picture() const;

  private:
    FocusGeometry lens_;
    int width_, height_;
    bool possible_, any_ = false;
    std::vector<double> light_;  ///< squares, stored as differences in x and y, which `picture` sums up
};

}  // namespace postlens
