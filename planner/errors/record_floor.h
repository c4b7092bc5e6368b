// The record floor: the error of an image that the spacing of its recorded samples causes. The samples show
// the position of an edge only to within a quadtree cell.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lens/focus_geometry.h"
#include "planner/errors/edge_cells.h"
#include "records/sample_file.h"

namespace postlens {

/// Returns the factor by which the lens's blur reduces the squared error of an edge whose position is
/// inexact. It is the number of pixels in the circle of confusion, because their errors are independent.
/// Along an edge that is `aligned` with the quadtree cells, errors are equal. The factor is then the number
/// of pixels across the circle.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// Some edges pass unseen between the corners of a quadtree cell. This factor, a fit, converts the error of
/// edges that the corners show to the error of all edges.
inline constexpr double floor_unseen = 1.4;

/// Estimates the squared error of each pixel's sRGB value, as a mean over channels, due to edges that are
/// known only to within a quadtree cell. The lens's blur reduces this error.
class RecordFloor {
  public:
    RecordFloor(const SampleHeader& header, const FocusGeometry& geometry);
    /// Adds the pixel rows [y_begin, y_end) of `band`. `leaves` are the undivided quadtree cells that
    /// find_leaves finds there. Several threads may add different rows.
    void add(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves);
    /// Returns a callback that passes the rows of a file to `add`. It keeps a reference to this object.
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

/// For each pixel of a sample file, returns the squared error that arises because edges are known only to
/// within a quadtree cell. Reads all records once.
[[nodiscard]] std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry);

}  // namespace postlens
