// Blurs runs of samples with SIMD. A run consists of adjacent samples that lie at pixel corners and have the
// same blur kernel, a disc. The samples of a run are blurred together.
#pragma once

#include <vector>

#include "focus/scatter/splat_tables.h"

namespace postlens {

/// Sums of the blurred samples in each pixel of a block: colour times kernel, and weight times kernel.
///
/// The kernels are discs centred on pixel corners, so their upper and lower halves are alike. A row of
/// samples is convolved with the lower half, and each result is added to two rows of the image.
///
/// In the uniform interior of a kernel, the convolution is a difference of two running sums of the samples.
/// The running sums use double, so that a bright sample leaves no rounding error to its right.
class RunScatter {
  public:
    /// Number of columns of the image that are computed together.
    static constexpr int strip_width = 64;

    explicit RunScatter(const SplatTables& tables);
    ~RunScatter();
    RunScatter(RunScatter&&) noexcept;
    RunScatter(const RunScatter&) = delete;
    RunScatter& operator=(const RunScatter&) = delete;
    RunScatter& operator=(RunScatter&&) = delete;

    /// Blurs all samples that reach the rectangle `block` of the image, and sums their light in each pixel of
    /// this rectangle. The results are then available by sums(). Returns false if no samples reach the block.
    bool run(const RasterWindow& block);

    /// Returns the sums of the blurred samples for one channel: an array with one value for each pixel in row
    /// y of a strip, which is `strip_width` columns wide. Channels 0 to 2 are the sums of the colours, and
    /// channel 3 is the sum of the weights.
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
    /// Adjacent samples with the same disc, prepared for filtering.
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
    std::vector<float> partial_;
    std::vector<double> total_;
    int touched_begin_ = 0, touched_end_ = 0;  ///< rows of the block with values in partial_
    int fresh_from_ = 0;                       ///< first row of the block without values in total_
    std::vector<LaidRun> laid_;
    std::vector<float> lines_;     ///< colours of the prepared runs, with zeros around them
    std::vector<double> running_;  ///< running sums of lines_
    std::size_t lines_used_ = 0, running_used_ = 0;
};

}  // namespace postlens
