// Estimates the error at edges of an image that is made from a sample file. The file contains samples only at
// the corners of small cells, so it does not tell exactly where an edge crosses a cell.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lens/focus_geometry.h"
#include "planner/errors/edge_cells.h"
#include "records/sample_file.h"

namespace postlens {

/// Returns the factor by which lens blur reduces the squared error at edges. The lens averages this error
/// over a circle of confusion with the diameter `coc_px`. If the edge is parallel to the quadtree cells
/// (`aligned`), averaging along the edge has no effect, because all cells there have the same error.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// Correction factor for the predicted squared error at edges (RecordFloor). The prediction considers only
/// the edges that the samples of the file show. But narrow objects may lie between the samples, so some edges
/// are missing. The factor accounts for these edges, and was fitted to measurements.
inline constexpr double floor_unseen = 1.4;

/// Estimates the squared error of each pixel's sRGB value that is due to edges. The samples show that an edge
/// crosses a quadtree cell, but not where. So the colour of the cell is uncertain.
class RecordFloor {
  public:
    RecordFloor(const SampleHeader& header, const FocusGeometry& geometry);
    /// Estimates the errors of the pixels in the rows [y_begin, y_end). `band` contains the records of these
    /// rows. `leaves` are the undivided cells of the quadtrees into which these pixels are divided, as
    /// find_leaves() returns them. Several threads may add different rows at the same time.
    void add(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves);
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

/// Returns, for each pixel, the squared error of its sRGB value that arises because the file does not contain
/// the exact positions of edges (RecordFloor). Reads all records of the file once.
[[nodiscard]] std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry);

}  // namespace postlens
