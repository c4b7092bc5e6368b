#include "focus/frame.h"

#include <algorithm>

#include "core/memory.h"
#include "core/threads.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {
namespace {

/// The file is read in groups of fewest_rows to rows_per_band rows. A group ends early once it has
/// enough_records surface samples.
constexpr int rows_per_band = 64, fewest_rows = 32;
constexpr std::uint64_t enough_records = 1U << 20U;
/// Number of rows that are read together and kept in memory. All threads wait for each other after each group
/// of rows, so small groups would be slow.
constexpr int kept_together = 256;

int band_end(const SampleFileReader& file, int y_begin, int y_end) {
    const auto facts = file.scanlines();
    std::uint64_t records = 0;
    for (int y = y_begin; y < std::min(y_end, y_begin + rows_per_band); ++y) {
        if (y >= y_begin + fewest_rows && records >= enough_records) return y;
        records += facts[static_cast<std::size_t>(y - file.y_begin())].records;
    }
    return std::min(y_end, y_begin + rows_per_band);
}

void read_rows(const SampleFileReader& file, int y_begin, int y_end, RecordBand& band) {
    file.read(std::max(y_begin - 1, file.y_begin()), std::min(y_end + 1, file.y_end()), band);
}

}  // namespace

FocusFrame::FocusFrame(const SampleFileReader& file, bool many) : file_(file), many_(many) {
    if (many) sheets_.resize(file.instants());
}

void FocusFrame::keep_all() {
    std::uint64_t records = 0;
    for (const ScanlineFacts& facts : file_.scanlines()) records += facts.records;
    // Checks that there is enough memory to keep the records and eye rays of all rows. The depth (a double)
    // and colour (three floats) of each record are stored a second time. The vector of eye rays (PointSample)
    // may reserve twice the memory it needs.
    require_memory(records * (sizeof(Record) + 2 * sizeof(PointSample) + sizeof(double) + 3 * sizeof(float)),
                   "the records of the frame");
    std::vector<Kept> all;
    for (int begin = file_.y_begin(); begin < file_.y_end(); begin += kept_together) {
        Kept& kept = all.emplace_back();
        kept.y_begin = begin;
        kept.y_end = std::min(begin + kept_together, file_.y_end());
        read_rows(file_, kept.y_begin, kept.y_end, kept.band);
        constexpr int step = FrameRows::rows_per_task;
        kept.samples.resize(static_cast<std::size_t>((kept.y_end - begin + step - 1) / step));
        kept.plain.resize(kept.samples.size());
        parallel_for(kept.samples.size(), [&](std::size_t task) {
            const int first = begin + static_cast<int>(task) * step;
            find_point_samples(kept.band, first, std::min(first + step, kept.y_end), file_.y_begin(),
                               file_.y_end() - 1, kept.samples[task]);
            find_plain_corners(kept.band, kept.samples[task], kept.plain[task]);
        });
    }
    rows_ = std::move(all);
}

void FocusFrame::visit_rows(int y_begin, int y_end, const std::function<void(const FrameRows&)>& visit) {
    if (many_) {
        if (rows_.empty()) keep_all();
        for (const Kept& kept : rows_) {
            if (kept.y_end <= y_begin || kept.y_begin >= y_end) continue;
            constexpr int step = FrameRows::rows_per_task;
            const int above = std::max(0, y_begin - kept.y_begin) / step,
                      tasks = (std::min(y_end, kept.y_end) - kept.y_begin + step - 1) / step - above;
            visit({&kept.band, kept.y_begin + above * step,
                   std::min(kept.y_begin + (above + tasks) * step, kept.y_end),
                   std::span(kept.samples)
                       .subspan(static_cast<std::size_t>(above), static_cast<std::size_t>(tasks)),
                   std::span(kept.plain)
                       .subspan(static_cast<std::size_t>(above), static_cast<std::size_t>(tasks))});
        }
        return;
    }
    RecordBand band;
    for (int begin = y_begin, end = begin; begin < y_end; begin = end) {
        end = band_end(file_, begin, y_end);
        read_rows(file_, begin, end, band);
        visit({&band, begin, end, {}, {}});
    }
}

std::shared_ptr<TreeSheets> FocusFrame::sheets(std::size_t instant, const HighlightRule& rule,
                                               const RecordsRead& also) {
    const auto read = [&] {
        if (instant != 0) return std::make_shared<TreeSheets>(tree_sheets(file_, instant, rule, also));
        std::optional<LargestBends> bends;
        if (file_.header().has_bend) bends.emplace(file_.header(), 0, file_.header().height);
        BorderDepths border(recorded_corners(file_));
        RecordsRead all = also;
        all.rows = [&](const RecordBand& band, int y_begin, int y_end) {
            if (bends) bends->add(band, y_begin, y_end);
            border.add(band, y_begin, y_end);
            if (also.rows) also.rows(band, y_begin, y_end);
        };
        auto out = std::make_shared<TreeSheets>(tree_sheets(file_, instant, rule, all));
        if (bends) bends_ = std::move(bends);
        border_.emplace(std::move(border));
        return out;
    };
    if (!many_) return read();
    std::shared_ptr<TreeSheets>& kept = sheets_[instant];
    if (kept) {
        take_highlights(*kept, rule);
        if ((also.rows || also.leaves) && instant == 0) {
            visit_rows(file_.y_begin(), file_.y_end(),
                       [&](const FrameRows& rows) { tell(also, *rows.band, rows.y_begin, rows.y_end); });
        }
    } else {
        kept = read();
    }
    return kept;
}

RasterWindow recorded_corners(const SampleFileReader& file) {
    return {file.x_begin(), file.x_end(), file.y_begin(), file.y_end()};
}

const BorderDepths& FocusFrame::border_depths() {
    if (!border_) {
        BorderDepths border(recorded_corners(file_));
        visit_rows(file_.y_begin(), file_.y_end(),
                   [&](const FrameRows& rows) { border.add(*rows.band, rows.y_begin, rows.y_end); });
        border_.emplace(std::move(border));
    }
    return *border_;
}

const LargestBends& FocusFrame::largest_bends(int y_begin, int y_end) {
    if (!bends_ || !bends_->covers(y_begin, y_end)) {
        LargestBends bends(file_.header(), y_begin, y_end);
        visit_rows(y_begin, y_end,
                   [&](const FrameRows& rows) { bends.add(*rows.band, rows.y_begin, rows.y_end); });
        bends_.emplace(std::move(bends));
    }
    return *bends_;
}

}  // namespace postlens
