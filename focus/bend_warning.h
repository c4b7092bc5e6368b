// Warns about surfaces, seen in mirrors or through glass, that reprojection draws at wrong positions.
// Reprojection assumes that their images move linearly with the lens point, but they may move nonlinearly.
#pragma once

#include <optional>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Returns a warning of the kind "nonlinear", with the share of pixels that reprojection to other lens points
/// draws wrongly. A pixel counts if its surface is misplaced by more than half a pixel when it is reprojected
/// to some point of the lens.
///
/// Returns nothing if no pixel counts, or if the file does not store reprojection errors (w_bend). If `crop`
/// is set, only pixels within it are counted.
[[nodiscard]] std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                                       const std::optional<Crop>& crop = std::nullopt);

/// Computes an image that shows where reprojection to other lens points misplaces light, and how much. It
/// contains the light of each surface sample whose position is wrong by more than half a pixel for some lens
/// point. The light of a sample is spread over a square as wide as the sample's blur.
class MisplacedLight {
  public:
    MisplacedLight(const SampleHeader& header, const FocusGeometry& lens);
    /// Adds the misplaced surface samples of the image rows [y_begin, y_end) to the image. `band` has the
    /// records of the sample file, and must contain these rows. Add every row exactly once, from top to
    /// bottom.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns the image that add() has summed: for each pixel, row by row, the radiance of the misplaced
    /// light. Returns an empty list if no light is misplaced.
    [[nodiscard]] std::vector<float> picture() const;

  private:
    FocusGeometry lens_;
    int width_, height_;
    bool possible_, any_ = false;
    std::vector<double> light_;  ///< squares, stored as differences in x and y, which `picture` sums up
};

}  // namespace postlens
