// Scattering runs of corner samples that share a disc: rows of neighbours at once, with vector arithmetic.
#pragma once

#include <vector>

#include "focus/splat_tables.h"

namespace postlens {

/// Sums of colour times response and of response alone over one block of pixels.
///
/// Kernel rows are symmetric, as the discs stand on whole coordinates: the filtered source row is the same
/// for two rows of the picture, and taps come in pairs. The inside of a row is a difference of running sums,
/// held in double, so that a bright light leaves no trace where it does not reach; all else adds up positive
/// terms, in float for a few source rows at a time, then in double. The order of every sum depends on the
/// tables alone.
class RunScatter {
  public:
    /// Pixels of a vector, and so of a strip of the block.
    static constexpr int strip_width = 64;

    explicit RunScatter(const SplatTables& tables);
    ~RunScatter();
    RunScatter(RunScatter&&) noexcept;
    RunScatter(const RunScatter&) = delete;
    RunScatter& operator=(const RunScatter&) = delete;
    RunScatter& operator=(RunScatter&&) = delete;

    /// Adds all runs that reach the block, a part of tables.picture(), to sums that start from zero. False
    /// where none does: then there are no sums. Buffers are kept from block to block.
    bool run(const RasterWindow& block);

    /// Sums `channel` (0..2 colour, 3 weight) of the strip's pixels in row y, strip_width of them; what lies
    /// beyond the block has no meaning.
    [[nodiscard]] const double* sums(int channel, int strip, int y) const {
        return total_.data() + index(channel, strip, y - block_.y_begin);
    }

  private:
    [[nodiscard]] std::size_t index(int channel, int strip, int row) const {
        return ((static_cast<std::size_t>(channel) * static_cast<std::size_t>(strips_) +
                 static_cast<std::size_t>(strip)) *
                    static_cast<std::size_t>(rows_) +
                static_cast<std::size_t>(row)) *
               strip_width;
    }
    /// A run made ready for filtering.
    struct LaidRun;
    void lay_run(const SplatRun& run, int y);
    void lay_line(LaidRun& laid, int channel, int line_end);
    void lay_running_sums(LaidRun& laid, int channels, int line_end);
    void filter_laid_runs();
    void flush();
    void flush_rows(int begin, int end, bool fresh);

    const SplatTables& tables_;
    RasterWindow block_;
    int strips_ = 0, rows_ = 0;
    /// Sums of the last few source rows; strip by strip, so that the rows of a strip are neighbours.
    std::vector<float> partial_;
    std::vector<double> total_;
    int touched_begin_ = 0, touched_end_ = 0;  ///< rows of the block that partial_ has something for
    int fresh_from_ = 0;                       ///< rows of the block from here on have nothing in total_ yet
    std::vector<LaidRun> laid_;
    std::vector<float> lines_;     ///< colours of the laid runs, zero around them
    std::vector<double> running_;  ///< running sums of lines
    std::size_t lines_used_ = 0, running_used_ = 0;
};

}  // namespace postlens
