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

/// Returns the factor by which the lens blur reduces the squared error at edges. This error arises because
/// samples are sparse. The lens averages it over a circle of confusion, whose diameter is `coc_px`. If the
/// edge is parallel to the cells of the quadtree (`aligned`), errors along the edge are equal, so averaging
/// reduces them less.
[[nodiscard]] double averaged_by(double coc_px, bool aligned);

/// Factor by which the estimated squared error at edges is multiplied. The estimate only knows those edges
/// that the samples show, but samples miss some edges entirely. The factor accounts for these, and was fitted
/// to measurements.
inline constexpr double floor_unseen = 1.4;

/// Estimates the squared error of each pixel's sRGB value that is due to edges. The samples lie at the
/// corners of quadtree cells. They show that an edge crosses a cell, but not where. So the fractions of the
/// cell on both sides of the edge are uncertain, and with them the pixel's colour.
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

/// Returns the squared error of each pixel's sRGB value that is due to edges, as RecordFloor estimates it.
/// Reads all records of the file once.
[[nodiscard]] std::vector<float> record_floor(const SampleFileReader& file, const FocusGeometry& geometry);

}  // namespace postlens
