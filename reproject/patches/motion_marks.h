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

/// Determines for each pixel which moving objects may change it. Objects that move alike form a group, and
/// each group has a bit mask (PatchField::class_marks). The result for a pixel is the bitwise or of the masks
/// of all groups that may change it.
class MotionMarks {
  public:
    /// Per pixel of a tile, PatchPicture::touched.
    using Touched = std::array<std::uint8_t, SeenTile::pixels>;

    /// Keeps a reference to `field`.
    explicit MotionMarks(const PatchField& field);
    [[nodiscard]] bool any() const { return !field_.class_marks.empty(); }
    [[nodiscard]] std::uint8_t of(std::size_t instant, std::uint32_t sheet) const {
        return marks_[instant][sheet];
    }
    /// Returns whether a wanted object is visible in any of the given patches (planar parts of surfaces).
    /// Objects that move alike form a group, and each group has a bit mask (PatchField::class_marks). The
    /// objects of a group are wanted if its mask and PatchField::wanted_marks have a common bit.
    [[nodiscard]] bool any_wanted(std::size_t instant, std::span<const std::uint32_t> patches) const;
    /// Marks the pixels of a tile in which a moving object was recorded at the instant number `instant`. At
    /// other instants, these pixels may show what lies behind the object. To mark a pixel is to add the bit
    /// mask of the object's group to `touched`.
    /// - `mesh`: the visible surfaces in the tile
    void mark_recorded(std::size_t instant, const PatchMesh& mesh, const TilePlace& at,
                       Touched& touched) const;
    /// Marks the pixels in which the view `v` shows a moving object: adds the bit mask of the object's group
    /// to `touched`. If the view shows no recorded surface in a pixel, all bits are set, because any object
    /// may appear there.
    /// - `seen`: the surfaces that the view shows, one SeenTile for each element of PatchView::uses
    void mark_seen(const PatchView& v, const TilePlace& at, const SeenTile* seen, Touched& touched) const;

  private:
    const PatchField& field_;
    std::vector<std::vector<std::uint8_t>> marks_;  ///< per instant and primary sheet
};

}  // namespace postlens
