// Where patches come to lie in all views together.
#pragma once

#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches.h"
#include "reproject/raster_rect.h"
#include "reproject/time_spans.h"

namespace postlens {

/// What a patch moves with: what is seen in a mirror or glass moves with that.
[[nodiscard]] std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch);

/// Rectangles that hold all that the views of a field have of a patch, and all that any point of the lens as
/// far as `lens_reach_px` has.
class PatchSweep {
  public:
    /// Keeps a reference to `field`, of which sets' views, motion_class and lens_reach_px are asked for.
    explicit PatchSweep(const PatchField& field);
    /// Raster px; nothing where no view has anything of it.
    [[nodiscard]] RasterRect of(const PatchMesh& mesh, const Patch& patch, std::size_t instant) const;

  private:
    /// A patch that does not move by itself lies affinely in the lens's point: the corners of a box around
    /// all of them bound it.
    struct Box {
        LensShift low, high;
        std::vector<TimeSpanViews> spans;  ///< where any class moves
        bool any = false;
        std::vector<std::uint8_t> moves;  ///< by motion class, as far as views have motions
    };
    void note(const PatchView& view);
    /// The box's corners, 4 or 8 of them more where views are offset.
    template <typename Add>
    static void for_corners(const Box& box, const Add& add);
    /// A patch that moves, in all of a span.
    static void add_span(const PatchMesh& mesh, const Patch& patch, std::size_t motion, const Box& box,
                         const TimeSpanViews& span, RasterRect& out);
    const PatchField& field_;
    std::vector<Box> boxes_;  ///< by instant
};

}  // namespace postlens
