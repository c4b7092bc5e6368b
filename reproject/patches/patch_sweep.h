// Bounding rectangles of patches over all views.
#pragma once

#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/patches.h"
#include "reproject/patches/time_spans.h"
#include "reproject/raster_rect.h"

namespace postlens {

/// Class of objects that move alike, for a patch. A patch of reflected or transmitted nodes has the class of
/// the object that reflects or transmits it.
[[nodiscard]] std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch);

/// Rectangles that contain a patch in all views of a field, and for all lens points within `lens_reach_px`.
class PatchSweep {
  public:
    /// Keeps a reference to `field`; uses its sets' views, motion_class and lens_reach_px.
    explicit PatchSweep(const PatchField& field);
    /// Rectangle of a patch, raster px; empty if no view uses the instant.
    [[nodiscard]] RasterRect of(const PatchMesh& mesh, const Patch& patch, std::size_t instant) const;

  private:
    /// Bounding box of the shifts by the lens (LensShift) in all views. The position of a patch that does not
    /// move is an affine function of the shift, so its positions at the box's corners bound all others.
    struct Box {
        LensShift low, high;
        std::vector<TimeSpanViews> spans;  ///< only if a motion class moves
        bool any = false;
        std::vector<std::uint8_t> moves;  ///< per class of objects: whether it moves in any view
    };
    void note(const PatchView& view);
    /// Calls `add` with the box's corners.
    template <typename Add>
    static void for_corners(const Box& box, const Add& add);
    /// Extends `out` by the positions of a moving patch in all views of a time span.
    static void add_span(const PatchMesh& mesh, const Patch& patch, std::size_t motion, const Box& box,
                         const TimeSpanViews& span, RasterRect& out);
    const PatchField& field_;
    std::vector<Box> boxes_;  ///< per instant
};

}  // namespace postlens
