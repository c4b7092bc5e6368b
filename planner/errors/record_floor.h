// Estimates the error at edges that remains with any number of lens points, because the file's samples are
// sparse.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lens/focus_geometry.h"
#include "planner/errors/edge_cells.h"
#include "records/sample_file.h"

namespace postlens {

/// Sparse samples cause an error at edges. Averaging over a circle of confusion, of diameter `coc_px`,
/// divides the squared error by the returned factor. Along an edge `aligned` with the quadtree, errors are
/// equal, so averaging reduces them less.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// The estimated squared error at edges is multiplied by this factor, because samples miss some edges
/// entirely. Fitted to measurements.
inline constexpr double floor_unseen = 1.4;

/// Estimates the squared error of each pixel's sRGB value that is due to edges. The samples lie at the
/// corners of quadtree cells. They show that an edge crosses a cell, but not where. So the fractions of the
/// cell on both sides of the edge are uncertain, and with them the pixel's colour.
class RecordFloor {
  public:
    RecordFloor(const SampleHeader& header, const FocusGeometry& geometry);
    /// Estimates the error of the pixel rows [y_begin, y_end), whose records are in `band`. `leaves` are the
    /// undivided quadtree cells that find_leaves finds there. Several threads may add different rows.
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

/// Returns the squared error of each pixel due to edges in a sample file. The samples show which quadtree
/// cell an edge crosses, but not where. Reads all records once.
[[nodiscard]] std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry);

}  // namespace postlens
