// The record floor: the error of an image that arises because records are point samples, so that the position
// of an edge is known only to within a quadtree cell.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lens/focus_geometry.h"
#include "planner/errors/edge_cells.h"
#include "records/sample_file.h"

namespace postlens {

/// Factor by which a circle of confusion reduces the squared error of an edge. The circle averages the errors
/// of the quadtree cells within it. If the errors are independent, the factor is the number of cells. Along
/// an edge that is `aligned` with the cells the errors are equal, and the factor is the number of cells
/// across the edge.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// Factor for edges that pass between the corners of a cell unseen: error of all quadtree cells / error of
/// the cells whose corners show an edge. Fitted (docs/planner.md).
inline constexpr double floor_unseen = 1.4;

/// Per pixel, the expected squared error (sRGB values, mean over channels) that the size of the quadtree
/// cells causes (edge_cells.h), reduced by the circle of confusion (averaged_by).
class RecordFloor {
  public:
    RecordFloor(const SampleHeader& header, const FocusGeometry& geometry);
    /// Adds the pixel rows [y_begin, y_end) of `band` with their leaves, from find_leaves. Several threads
    /// may add different rows at the same time.
    void add(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves);
    /// `add` as a callback for readers of records. Keeps a reference to this.
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

/// The record floor of a file, per pixel. Reads all records once.
[[nodiscard]] std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry);

}  // namespace postlens
