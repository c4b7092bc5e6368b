// A sample file on its way to pictures: read for each, or kept for many.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "focus/largest_bends.h"
#include "focus/plain_corners.h"
#include "records/quadtree.h"
#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

struct HighlightRule;
struct TreeSheets;

/// Corner rows [y_begin, y_end) of the frame's own instant. `band` has one row more above and below, where
/// the file has one. `samples`: their point samples, `rows_per_task` rows together, and `plain`: which of
/// these are plain corners; empty: not looked for.
struct FrameRows {
    /// find_point_samples looks at one row more on either side of what it is asked for.
    static constexpr int rows_per_task = 8;
    const RecordBand* band = nullptr;
    int y_begin = 0, y_end = 0;
    std::span<const PointSamples> samples;
    std::span<const PlainCorners> plain;
};

/// What pictures of any lens have in common: the records, their point samples, the sheets of the light field.
/// To be used by one thread at a time, but for what keeps its rows and has visited one: these may be visited
/// by any number. Every picture has the same bits whether anything is kept or not.
class FocusFrame {
  public:
    /// `many`: what is read is kept for the pictures to come, the records of the frame's own instant for
    /// those by splats, the sheets of every instant asked for for those by light field. Keeps a reference to
    /// `file`.
    explicit FocusFrame(const SampleFileReader& file, bool many = false);

    [[nodiscard]] const SampleFileReader& file() const { return file_; }
    [[nodiscard]] bool many() const { return many_; }

    /// Calls visit(rows) from the top for bands of rows that together hold [y_begin, y_end), and maybe more.
    /// Throws what the reader throws and, before more is kept than there is room for, Error(out_of_memory).
    void visit_rows(int y_begin, int y_end, const std::function<void(const FrameRows&)>& visit);

    /// `tree_sheets`; good until the next call for the same instant. All rules must have the same limit.
    /// `also` is told of the records of the instant, each row of the file once, and with instant 0 only.
    [[nodiscard]] std::shared_ptr<TreeSheets> sheets(std::size_t instant, const HighlightRule& rule,
                                                     const RecordsRead& also = {});

    /// Of rows [y_begin, y_end) of the picture at least. What the sheets of instant 0 were made of has not to
    /// be read for it again.
    [[nodiscard]] const LargestBends& largest_bends(int y_begin, int y_end);

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
    std::vector<std::shared_ptr<TreeSheets>> sheets_;  ///< by instant
    std::optional<LargestBends> bends_;
};

}  // namespace postlens
