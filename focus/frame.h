// Provides the records of a sample file for making images. Records are either kept in memory or read again
// for each image.
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

/// Rows [y_begin, y_end) of the records of the frame's own instant. `band` also has the row above and the row
/// below, if the file has them. `samples` contains the point samples, with one element per `rows_per_task`
/// rows. It is empty if samples are not kept. `plain` contains the samples at corners of undivided pixels
/// (focus/scatter/plain_corners.h), with the same number of rows per element.
struct FrameRows {
    /// Rows per task. A task of few rows would be inefficient, because find_point_samples also reads one row
    /// above and one row below.
    static constexpr int rows_per_task = 8;
    const RecordBand* band = nullptr;
    int y_begin = 0, y_end = 0;
    std::span<const PointSamples> samples;
    std::span<const PlainCorners> plain;
};

[[nodiscard]] RasterWindow recorded_corners(const SampleFileReader& file);

/// The data that images of any lens share: records, point samples, and the sheets (surfaces within squares of
/// the raster) of the light field. Images are bit-identical whether data are kept or not. Only one thread at
/// a time may use a frame. The exception is visit_rows: several threads may call it if the frame keeps its
/// rows and has visited them once.
class FocusFrame {
  public:
    /// `many` states that several images are made, so the frame keeps its data. It keeps the records of the
    /// frame's own instant, for scattering, and the sheets of every instant in use, for the light field. The
    /// frame keeps a reference to `file`.
    explicit FocusFrame(const SampleFileReader& file, bool many = false);

    [[nodiscard]] const SampleFileReader& file() const { return file_; }
    [[nodiscard]] bool many() const { return many_; }

    /// Calls visit(rows) for bands of rows, from the top down. Together the bands contain the rows [y_begin,
    /// y_end), and possibly more. Throws the errors of the reader. Throws Error(out_of_memory) if the data to
    /// keep would exceed the memory.
    void visit_rows(int y_begin, int y_end, const std::function<void(const FrameRows&)>& visit);

    /// Returns the sheets (surfaces within squares of the raster) of a recorded instant. The result is valid
    /// until the next call for the same instant. All calls must use rules with the same limit. For instant 0,
    /// `also` is called once for each row of the file. For other instants, `also` is not called.
    [[nodiscard]] std::shared_ptr<TreeSheets> sheets(std::size_t instant, const HighlightRule& rule,
                                                     const RecordsRead& also = {});

    /// Returns, for each pixel, the largest w_bend, the error of the linear reprojection by the matrix W. The
    /// result has at least the rows [y_begin, y_end) of the image. The records are not read again if the
    /// surfaces of instant 0 have already been built.
    [[nodiscard]] const LargestBends& largest_bends(int y_begin, int y_end);

    /// Returns the depths at the border of the records of the frame's own instant. The records are not read
    /// again if the surfaces of instant 0 have already been built.
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
