// Provides the surface samples (records) of a sample file for computing images. They are kept in memory, or
// read again for each image.
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

/// The rows [y_begin, y_end) of the sample file, at its first recorded instant.
/// - `band`: the records (surface samples) of these rows and of the rows directly above and below
/// - `samples`: the eye rays through pixels of these rows, with the surfaces that they hit; one element for
///   each group of `rows_per_task` rows. Empty if not computed.
/// - `plain`: the most frequent eye rays, which meet no mirror or glass and lie at corners of undivided
///   pixels, in a compact form (PlainCorners); grouped as in `samples`. Empty if not computed.
struct FrameRows {
    /// Number of rows per task. Fewer rows would be inefficient, because each task also reads the row above
    /// and the row below.
    static constexpr int rows_per_task = 8;
    const RecordBand* band = nullptr;
    int y_begin = 0, y_end = 0;
    std::span<const PointSamples> samples;
    std::span<const PlainCorners> plain;
};

[[nodiscard]] RasterWindow recorded_corners(const SampleFileReader& file);

/// Reads the data of a sample file from which the images of all lenses are computed. These data are surface
/// samples (records), the eye rays to which they belong (point samples), and the surfaces that neighbouring
/// records form (sheets).
///
/// Only one thread at a time may use a frame, except that several threads may call visit_rows if the frame
/// keeps its rows in memory and a first call has visited them.
class FocusFrame {
  public:
    /// If `many` is true, the file's data are kept in memory, which is faster if several images are made from
    /// them. The object keeps a reference to `file`.
    explicit FocusFrame(const SampleFileReader& file, bool many = false);

    [[nodiscard]] const SampleFileReader& file() const { return file_; }
    [[nodiscard]] bool many() const { return many_; }

    /// Calls visit(rows) for one group of rows after another, from top to bottom. Together, the groups
    /// contain the rows [y_begin, y_end), and sometimes a few more rows. Throws errors of the file reader,
    /// and Error(out_of_memory).
    void visit_rows(int y_begin, int y_end, const std::function<void(const FrameRows&)>& visit);

    /// Returns all surfaces that the sample file records at one instant, cut into squares of 16 x 16 px. The
    /// result is valid until the next call for this instant.
    /// - `rule`: selects the bright light that is stored separately from the surfaces; `rule.above`, the
    ///   radiance above which light counts as bright, must be the same in all calls
    /// - `also`: functions that receive the records of each row once, while they are read; only called for
    ///   instant 0
    [[nodiscard]] std::shared_ptr<TreeSheets> sheets(std::size_t instant, const HighlightRule& rule,
                                                     const RecordsRead& also = {});

    /// Returns for each pixel the largest nonlinearity of its surfaces (Record::w_bend), in 1/m^2. It limits
    /// the error of a surface's position if the surface is moved linearly with the lens point (see
    /// LargestBends). The result contains at least the image rows [y_begin, y_end).
    [[nodiscard]] const LargestBends& largest_bends(int y_begin, int y_end);

    /// Returns the depths of the surfaces at the border of the traced area (image and overscan), at the first
    /// recorded instant.
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
