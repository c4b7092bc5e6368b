// Does what mirrors and glass show move with the lens as W says?
#pragma once

#include <optional>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// A warning of code "nonlinear" with the share of the picture's pixels that have a visible node brighter
/// than 1/255 which W misplaces by more than half a pixel for some point of the lens: where
/// (d / pitch) W.bend (D / 2)^2 > 0.5 px. Nothing where there is none, for a pinhole, and for files that do
/// not say (`SampleHeader::has_bend`). Reads the records of the picture once, or not at all if `frame` has
/// them (FocusFrame::largest_bends); the same for any number of threads. `crop`: of these pixels of the
/// traced picture only.
[[nodiscard]] std::optional<FocusWarning> bend_warning(FocusFrame& frame, const FocusGeometry& lens,
                                                       const std::optional<Crop>& crop = std::nullopt);

/// Where that light goes: by pixel of the picture, the radiance of such nodes, each spread over a square as
/// wide as its blur.
class MisplacedLight {
  public:
    MisplacedLight(const SampleHeader& header, const FocusGeometry& lens);
    /// Takes in the records of rows [y_begin, y_end) of `band`: each row of the file once, in order.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Empty where bend_warning has nothing to say.
    [[nodiscard]] std::vector<float> picture() const {
        return any_ ? summed_up(light_) : std::vector<float>();
    }
    /// That light times how far from where W puts it a point of the lens's rim sees it, px, farthest_px at
    /// most; empty likewise.
    [[nodiscard]] std::vector<float> moved_px() const {
        return any_ ? summed_up(moved_) : std::vector<float>();
    }
    static constexpr double farthest_px = 32;

  private:
    FocusGeometry lens_;
    int width_, height_;
    bool possible_, any_ = false;
    [[nodiscard]] std::vector<float> summed_up(const std::vector<double>& of) const;
    std::vector<double> light_, moved_;  ///< squares as differences in both directions, summed up in the end
};

}  // namespace postlens
