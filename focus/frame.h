// Provides the records of a sample file for making images. Records are either read again for each image or
// kept in memory.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "focus/border_depths.h"
#include "focus/largest_bends.h"
#include "focus/scatter/plain_corners.h"
#include "records/quadtree.h"
#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

struct HighlightRule;
struct TreeSheets;

/// Rows [y_begin, y_end) of the records of the frame's own instant. `band` has one more row above and below,
/// if the file has it. `samples` contains the point samples, one element per `rows_per_task` rows; it is
/// empty if samples are not kept. `plain` contains the samples at corners of undivided pixels
/// (focus/scatter/plain_corners.h), with the same number of rows per element.
struct FrameRows {
    /// Rows per task. find_point_samples also reads one row above and one below, so a task of few rows would
    /// be inefficient.
    static constexpr int rows_per_task = 8;
    const RecordBand* band = nullptr;
    int y_begin = 0, y_end = 0;
    std::span<const PointSamples> samples;
    std::span<const PlainCorners> plain;
};

[[nodiscard]] RasterWindow recorded_corners(const SampleFileReader& file);

/// The data that images of any lens share: records, point samples, and the surfaces (sheets) of the light
/// field. Only one thread at a time may use a frame, with one exception: several threads may call visit_rows
/// if the frame keeps its rows and they have been visited once. Images are bit-identical whether data are
/// kept or not.
class FocusFrame {
  public:
    /// `many`: keeps data for several images, namely the records of the frame's own instant, for scattering,
    /// and the surfaces (sheets) of every instant in use, for the light field. Keeps a reference to `file`.
    explicit FocusFrame(const SampleFileReader& file, bool many = false);

    [[nodiscard]] const SampleFileReader& file() const { return file_; }
    [[nodiscard]] bool many() const { return many_; }

    /// Calls visit(rows) for bands of rows, from the top down. Together the bands contain the rows [y_begin,
    /// y_end), and possibly more. Throws the reader's errors, and Error(out_of_memory) before the kept data
    /// exceed the memory.
    void visit_rows(int y_begin, int y_end, const std::function<void(const FrameRows&)>& visit);

    /// Returns the sheets (surfaces within squares of the raster) of a recorded instant, valid until the next
    /// call for the same instant. All calls must use rules with the same limit. `also` is called once for
    /// each row of the file, and only for instant 0.
    [[nodiscard]] std::shared_ptr<TreeSheets> sheets(std::size_t instant, const HighlightRule& rule,
                                                     const RecordsRead& also = {});

    /// Per pixel, the largest error w_bend of the linear reprojection by the matrix W. The result has at
    /// least the rows [y_begin, y_end) of the image. If the surfaces of instant 0 were built before, the
    /// records are not read again.
    [[nodiscard]] const LargestBends& largest_bends(int y_begin, int y_end);

    /// Depths at the border of the records of the frame's own instant. If the surfaces of instant 0 were
    /// built before, the records are not read again.
    [[nodiscard]] const BorderDepths& border_depths();

  private:
    struct Kept {
        RecordBand band;
        int y_begin = 0, y_end = 0;
        std::vector<PointSamples> samples;
        std::vector<PlainCorners> plain;
    };
    void keep_all();

    const SampleFileReader& file_;
    bool many_;
    std::vector<Kept> rows_;
    std::vector<std::shared_ptr<TreeSheets>> sheets_;  ///< per instant
    std::optional<LargestBends> bends_;
    std::optional<BorderDepths> border_;
};

}  // namespace postlens
