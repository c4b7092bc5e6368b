// Bounding rectangles of patches over all views.
#pragma once

#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches.h"
#include "reproject/raster_rect.h"
#include "reproject/time_spans.h"

namespace postlens {

/// Motion class of a patch. Reflected and transmitted nodes have that of the object that shows them.
[[nodiscard]] std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch);

/// Rectangles that contain a patch in all views of a field, and for all lens points within `lens_reach_px`.
class PatchSweep {
  public:
    /// Keeps a reference to `field`; uses its sets' views, motion_class and lens_reach_px.
    explicit PatchSweep(const PatchField& field);
    /// Rectangle of a patch, raster px; empty if no view uses the instant.
    [[nodiscard]] RasterRect of(const PatchMesh& mesh, const Patch& patch, std::size_t instant) const;

  private:
    /// Bounding box of all lens shifts. The position of a patch without motion is affine in the shift, so the
    /// box's corners bound it.
    struct Box {
        LensShift low, high;
        std::vector<TimeSpanViews> spans;  ///< only if a motion class moves
        bool any = false;
        std::vector<std::uint8_t> moves;  ///< per motion class, whether it moves in any view
    };
    void note(const PatchView& view);
    /// Calls `add` with the box's corners.
    template <typename Add>
    static void for_corners(const Box& box, const Add& add);
    /// Extends `out` by a moving patch over a span.
    static void add_span(const PatchMesh& mesh, const Patch& patch, std::size_t motion, const Box& box,
                         const TimeSpanViews& span, RasterRect& out);
    const PatchField& field_;
    std::vector<Box> boxes_;  ///< per instant
};

}  // namespace postlens
