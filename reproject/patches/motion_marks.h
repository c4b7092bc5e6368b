// Marks the pixels that moving objects may change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// Marks the pixels that moving objects may change, with the bits PatchField::class_marks of the object.
class MotionMarks {
  public:
    /// Per pixel of a tile, PatchPicture::touched.
    using Touched = std::array<std::uint8_t, SeenTile::pixels>;

    /// Keeps a reference to `field`.
    explicit MotionMarks(const PatchField& field);
    /// Whether the field has marks.
    [[nodiscard]] bool any() const { return !field_.class_marks.empty(); }
    [[nodiscard]] std::uint8_t of(std::size_t instant, std::uint32_t sheet) const {
        return marks_[instant][sheet];
    }
    /// Returns whether any of `patches` (indices of directly visible planar parts of surfaces) belongs to an
    /// object with a bit of PatchField::wanted_marks.
    [[nodiscard]] bool any_wanted(std::size_t instant, std::span<const std::uint32_t> patches) const;
    /// Marks the pixels where a moving object was recorded, because it uncovers them in other views. `mesh`
    /// contains the instant's directly visible patches in the tile.
    void mark_recorded(std::size_t instant, const PatchMesh& mesh, const TilePlace& at,
                       Touched& touched) const;
    /// Marks the pixels in which a view sees a moving object or something unrecorded. `seen` has one element
    /// per recorded instant of the view.
    void mark_seen(const PatchView& v, const TilePlace& at, const SeenTile* seen, Touched& touched) const;

  private:
    const PatchField& field_;
    std::vector<std::vector<std::uint8_t>> marks_;  ///< per instant and primary sheet
};

}  // namespace postlens
