// Marks pixels where moving objects are recorded or seen.
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

/// The bits of PatchField::class_marks, per instant and primary sheet.
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
    /// Whether one of the primary patches has a mark that the field wants. `patches`: their numbers.
    [[nodiscard]] bool any_wanted(std::size_t instant, std::span<const std::uint32_t> patches) const;
    /// Marks pixels where an instant's records show a moving object: their colour differs from that of the
    /// views. `mesh`: the instant's primary patches in the tile.
    void mark_recorded(std::size_t instant, const PatchMesh& mesh, const TilePlace& at,
                       Touched& touched) const;
    /// Marks pixels where a view sees a moving object or nothing. `seen`: per use of the view.
    void mark_seen(const PatchView& v, const TilePlace& at, const SeenTile* seen, Touched& touched) const;

  private:
    const PatchField& field_;
    std::vector<std::vector<std::uint8_t>> marks_;  ///< per instant and primary sheet
};

}  // namespace postlens
