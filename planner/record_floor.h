// How far a picture from records is from the truth because records are points: where an edge crosses a cell
// of the quadtree is known to its corners only.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lens/focus_geometry.h"
#include "planner/edge_cells.h"
#include "records/sample_file.h"

namespace postlens {

/// What a circle of confusion divides the squared error of an edge by. One circle averages the errors of the
/// cells in it, which is their number; those along an edge that runs along the cells are alike, and what is
/// averaged then is the way across.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// What cells that no edge is seen in hide, since all of their corners miss it, adds to the error of those
/// where one is seen: fitted (docs/planner.md).
inline constexpr double floor_unseen = 1.4;

/// By pixel of the picture: the expected squared error (mean of the channels, encoded values) that comes of
/// the size of the quadtrees' cells (edge_cells.h), less what circles of confusion average out.
class RecordFloor {
  public:
    RecordFloor(const SampleHeader& header, const FocusGeometry& geometry);
    /// Takes in rows [y_begin, y_end) of pixels of `band` with their leaves, as find_leaves has them; safe
    /// for several rows at once.
    void add(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves);
    /// That, for those who read the records. Keeps a reference.
    [[nodiscard]] auto adds() {
        return [this](const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves) {
            add(band, y_begin, y_end, leaves);
        };
    }
    [[nodiscard]] std::vector<float> picture() && { return std::move(mse_); }
    [[nodiscard]] const std::vector<float>& picture() const& { return mse_; }

  private:
    [[nodiscard]] float pixel_error(std::span<const Leaf> leaves, std::span<const CellCorner> corners) const;

    int width_, height_;
    FocusGeometry geometry_;
    std::vector<float> mse_;
};

/// The same of a whole file, whose records it reads once.
[[nodiscard]] std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry);

}  // namespace postlens
