// Computes rectangles that contain a patch in all views.
#pragma once

#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/patches.h"
#include "reproject/patches/time_spans.h"
#include "reproject/raster_rect.h"

namespace postlens {

/// Returns the number of the group of objects with which a patch (planar part of a surface) moves. A patch
/// that is seen by reflection or transmission is assumed to move with its mirror or glass.
[[nodiscard]] std::size_t motion_class_of(const PatchField& field, const PatchMesh& mesh, const Patch& patch);

/// Computes a rectangle that contains the image of a patch (planar part of a surface) in all views (images
/// for one lens point and instant). Only the tiles (squares) of the image that the rectangle touches need to
/// draw the patch.
class PatchSweep {
  public:
    /// Keeps a reference to `field`.
    explicit PatchSweep(const PatchField& field);
    /// Returns a rectangle, in raster px, that contains the image of `patch` (planar part of a surface) for
    /// all lens points and instants. Only images made from the records of the instant number `instant` count.
    /// The rectangle is empty if there are none.
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
