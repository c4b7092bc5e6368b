// Two sets of views of the light field, and what the records say that they lack: what every expectation of
// an error starts from.
#pragma once

#include <memory>
#include <vector>

#include "focus/field_focus.h"
#include "planner/hybrid.h"

namespace postlens {

/// Errors are expected squared ones, encoded values, means of the channels; those by pixel are of the whole
/// picture, row by row.
class Pilot {
  public:
    /// Draws sets `first_set` and the one after it, of `views` points of the lens each, for `lens.focus`'
    /// lens and the shutter; as the trace has it framed. `lens.focus.crop`: nothing else is known. Throws
    /// what field_focus throws.
    Pilot(FocusFrame& frame, const HybridSettings& lens, int views, int first_set = 0);

    [[nodiscard]] const FieldFocuser& focuser() const { return *focuser_; }
    [[nodiscard]] const FocusGeometry& geometry() const { return geometry_; }
    [[nodiscard]] const Aperture& aperture() const { return aperture_; }

    Image a, b;                          ///< the sets' means, scene-linear
    std::vector<float> noise;            ///< of one set, as the two differ
    std::vector<float> floor;            ///< of the records' density, without what no cell sees (RecordFloor)
    std::vector<float> aligned, spread;  ///< parts of it, see RecordFloor
    std::vector<float> hidden;           ///< of what no record shows and of what W misplaces
    std::vector<float> light_square;     ///< see FieldFocus

  private:
    FocusGeometry geometry_;
    Aperture aperture_;
    std::unique_ptr<FieldFocuser> focuser_;
};

/// Of a set of views by itself, for a pilot of so many whose error is 1.
[[nodiscard]] double noise_of_set(int pilot_views, int views);

/// Expected squared error of `views` views, of which `pilot_mse` is that of `pilot_views`: two such sets, and
/// one of all others, whose own falls with a power of their number (docs/planner.md has the fit), each
/// weighted by what it is worth.
[[nodiscard]] double noise_of_views(double pilot_mse, int pilot_views, int views);

/// Of two sets together, where one of them is off by 1: they are independent.
inline constexpr double two_sets = 0.5;

/// Of the floor of pixels that are traced again, what is in others: edges run on where no corner sees them.
/// In calibrating tiles that had a third of their pixels or fewer traced again 0.11 to 0.39, mostly 0.2.
inline constexpr double still_unseen = 0.2;

}  // namespace postlens
