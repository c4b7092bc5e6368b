// Scattering runs of corner samples that share a disc: rows of neighbours at once, with vector arithmetic.
#pragma once

#include <array>
#include <vector>

#include "focus/splat_tables.h"

namespace postlens {

/// Sums of colour times response and of response alone over one block of pixels.
///
/// Kernel rows are symmetric, as the discs stand on whole coordinates: the filtered source row is the same for
/// two rows of the picture, and taps come in pairs. The inside of a row is a difference of running sums, held in
/// double, so that a bright light leaves no trace where it does not reach; all else adds up positive terms, in
/// float for a few source rows at a time, then in double. The order of every sum depends on the tables alone.
class RunScatter {
  public:
    /// Pixels of a vector, and so of a strip of the block.
    static constexpr int strip_width = 32;

    /// The block lies in tables.picture().
    RunScatter(const SplatTables& tables, const RasterWindow& block);

    /// Adds all runs that reach the block. False where none does: then all sums are zero.
    bool run();

    /// Sums `channel` (0..2 colour, 3 weight) of the strip's pixels in row y, strip_width of them; what lies beyond
    /// the block has no meaning.
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
    struct Line;
    void add_run(const SplatRun& run, int y);
    void lay_colours(const Line& line, int y);
    void lay_ones(const Line& line);
    void flush();

    const SplatTables& tables_;
    RasterWindow block_;
    int strips_, rows_;
    std::vector<float> partial_;  ///< of the last few source rows; strip by strip, so that a strip's rows are neighbours
    std::vector<double> total_;
    int touched_begin_, touched_end_;  ///< rows of the block that partial_ has something for
    std::array<std::vector<float>, 4> line_;      ///< the run's colours and its extent, zero around it
    std::array<std::vector<double>, 4> running_;  ///< running sums of line_
};

}  // namespace postlens
