// Warning about nonlinear W. For some lens points, the matrix W reprojects reflected and transmitted surfaces
// to wrong positions.
#pragma once

#include <optional>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Returns a warning of code "nonlinear", with the share of the image's pixels that show a misplaced node. A
/// node is misplaced if it is visible, brighter than 1/255, and reprojected by W with an error of more than
/// half a pixel for some lens point: (film distance / pixel pitch) w_bend (D / 2)^2 > 0.5 px, where D is the
/// aperture's diameter. Returns nothing if no pixel shows a misplaced node, for a pinhole, and for files
/// without w_bend (`SampleHeader::has_bend`).
///
/// Reads the records once. They are not read if `frame` already has their errors (FocusFrame::largest_bends).
/// The result does not depend on the number of threads. With `crop`, only these pixels of the traced image
/// count.
[[nodiscard]] std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                                       const std::optional<Crop>& crop = std::nullopt);

/// Image of the light that W reprojects to wrong positions. It contains the radiance of all nodes that
/// bend_warning counts, each spread over a square as wide as the node's blur.
class MisplacedLight {
  public:
    MisplacedLight(const SampleHeader& header, const FocusGeometry& lens);
    /// Adds the records of rows [y_begin, y_end) of `band`. The caller must add each row of the file exactly
    /// once, in order.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Misplaced radiance per pixel, row by row. Empty if no node is misplaced.
    [[nodiscard]] std::vector<float> picture() const;

  private:
    FocusGeometry lens_;
    int width_, height_;
    bool possible_, any_ = false;
    std::vector<double> light_;  ///< squares, stored as differences in x and y, which `picture` sums up
};

}  // namespace postlens
