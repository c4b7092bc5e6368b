// The record floor: the error that remains in an image with any number of views, because the recorded samples
// are too far apart. They show which quadtree cells an edge crosses, but not where in a cell.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lens/focus_geometry.h"
#include "planner/errors/edge_cells.h"
#include "records/sample_file.h"

namespace postlens {

/// Returns the factor by which the lens's blur reduces the squared error of an edge whose position is
/// inexact. The blur averages the errors of all pixels in the circle of confusion. If these errors are
/// independent, the factor is the number of these pixels. Along an edge `aligned` with the quadtree cells,
/// the errors are equal, so the factor is only the number of pixels across the circle.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// An edge that crosses a quadtree cell without separating its corners is not visible in the samples. This
/// factor converts the error of the visible edges to that of all edges. It was fitted to measured errors.
inline constexpr double floor_unseen = 1.4;

/// Estimates the squared error of each pixel's sRGB value, as a mean over channels, due to inexact positions
/// of edges. The samples show which quadtree cells an edge crosses, but not where in a cell. The lens's blur
/// reduces this error.
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
