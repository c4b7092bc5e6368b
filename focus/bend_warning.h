// Warns about surfaces, seen in mirrors or through glass, that reprojection draws at wrong positions.
// Reprojection assumes that their images move linearly with the lens point, but they may move nonlinearly.
#pragma once

#include <optional>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Returns a warning of the kind "nonlinear". It states the share of pixels whose surface, seen in a mirror
/// or through glass, is drawn more than half a pixel beside its true position when it is reprojected to other
/// lens points.
///
/// Returns nothing if no pixel counts, or if the file does not store reprojection errors (w_bend). If `crop`
/// is set, only pixels within it are counted.
[[nodiscard]] std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                                       const std::optional<Crop>& crop = std::nullopt);

/// Computes an image that shows where reprojection to other lens points misplaces light, and how much. It
/// contains the light of each surface sample whose position is wrong by more than half a pixel, spread over a
/// square as wide as the sample's blur.
class MisplacedLight {
  public:
    MisplacedLight(const SampleHeader& header, const FocusGeometry& lens);
    /// Adds the light of the misplaced surface samples in the pixel rows [y_begin, y_end) to the image that
    /// this object computes. `band` holds the records of the sample file, and must contain these rows. Add
    /// every row exactly once, from top to bottom.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns the image that the calls of add() have summed up. For each pixel, row by row, it contains the
    /// radiance of the light that reprojection to some lens point draws at a wrong position. The image is
    /// empty if there is no such light.
    [[nodiscard]] std::vector<float> picture() const;

  private:
    FocusGeometry lens_;
    int width_, height_;
    bool possible_, any_ = false;
    std::vector<double> light_;  ///< squares, stored as differences in x and y, which `picture` sums up
};

}  // namespace postlens
