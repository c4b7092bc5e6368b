// Warns about objects in mirrors and glass that are drawn at wrong positions. Their images move nonlinearly
// when the lens point moves, but reprojection is linear.
#pragma once

#include <optional>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Returns a warning of code "nonlinear", with the share of pixels that show an object at a wrong position.
/// There, reprojection to some lens point is wrong by more than half a pixel.
///
/// Returns nothing if no pixel is affected, or if the file has no error of reprojection (w_bend). With a
/// `crop`, only pixels within it count.
[[nodiscard]] std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                                       const std::optional<Crop>& crop = std::nullopt);

/// Image of the light that reprojection to some lens point puts more than half a pixel from its true
/// position. Each surface sample is spread over a square as wide as its blur.
class MisplacedLight {
  public:
    MisplacedLight(const SampleHeader& header, const FocusGeometry& lens);
    /// Adds the surface samples of the image rows [y_begin, y_end), which `band` must contain. Add every row
    /// exactly once, from top to bottom.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Returns, for each pixel, the radiance that linear reprojection puts at a wrong position. Returns an
    /// empty list if there is none.
    [[nodiscard]] std::vector<float> picture() const;

  private:
    FocusGeometry lens_;
    int width_, height_;
    bool possible_, any_ = false;
    std::vector<double> light_;  ///< squares, stored as differences in x and y, which `picture` sums up
};

}  // namespace postlens
