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

/// Determines which groups of moving objects may change each pixel. Each group has a bit mask
/// (PatchField::class_marks). The result for a pixel combines the masks of its groups.
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
    /// Returns whether any of the given patches (parts of visible surfaces) belongs to a wanted object. An
    /// object is wanted if its bit mask (PatchField::class_marks) has a bit of PatchField::wanted_marks.
    [[nodiscard]] bool any_wanted(std::size_t instant, std::span<const std::uint32_t> patches) const;
    /// Marks the pixels of a tile in which a moving object was recorded: at other instants, the object leaves
    /// these pixels and uncovers the background. `mesh` holds the visible surfaces in the tile.
    void mark_recorded(std::size_t instant, const PatchMesh& mesh, const TilePlace& at,
                       Touched& touched) const;
    /// Marks the pixels in which the view `v` shows a moving object or no recorded surface. `seen` holds the
    /// surfaces that `v` shows. It has one element per element of PatchView::uses, i.e. one or two.
    void mark_seen(const PatchView& v, const TilePlace& at, const SeenTile* seen, Touched& touched) const;

  private:
    const PatchField& field_;
    std::vector<std::vector<std::uint8_t>> marks_;  ///< per instant and primary sheet
};

}  // namespace postlens
