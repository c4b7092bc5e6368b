// Computes rectangles that contain a patch in all views.
#pragma once

#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/patches.h"
#include "reproject/patches/time_spans.h"
#include "reproject/raster_rect.h"

namespace postlens {

/// Objects with the same motion form a group. Returns the number of the group with which a patch (planar part
/// of a surface) moves. Reflected or transmitted patches move with their mirror or glass.
[[nodiscard]] std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch);

/// Computes rectangles that contain a patch (planar part of a surface) as seen from all lens points and at
/// all instants of an image.
class PatchSweep {
  public:
    /// Keeps a reference to `field`.
    explicit PatchSweep(const PatchField& field);
    /// Returns the rectangle, in raster px, that contains the patch in all views that use the recorded
    /// instant number `instant`. It is empty if no view uses this instant.
    [[nodiscard]] RasterRect of(const PatchMesh& mesh, const Patch& patch, std::size_t instant) const;

  private:
    struct Box {
        LensShift low, high;
        std::vector<TimeSpanViews> spans;  ///< only if a motion class moves
        bool any = false;
        std::vector<std::uint8_t> moves;  ///< for each class of objects, whether it moves in any view
    };
    void note(const PatchView& view);
    template <typename Add>
    static void for_corners(const Box& box, const Add& add);
    static void add_span(const PatchMesh& mesh, const Patch& patch, std::size_t motion, const Box& box,
                         const TimeSpanViews& span, RasterRect& out);
    const PatchField& field_;
    std::vector<Box> boxes_;  ///< per instant
};

}  // namespace postlens
