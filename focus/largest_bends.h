// By pixel, the most that W errs by for what the pinhole sees there.
#pragma once

#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Darker nodes no picture of eight bits shows.
inline constexpr float darkest_shown = 1.0F / 255;

/// The greatest W.bend, m^-2 (records/record.h), of a pixel's nodes of layer 0 that are brighter than
/// darkest_shown. Of no lens: one of diameter D sees such a node up to (d / pitch) W.bend (D / 2)^2 px from
/// where its W puts it.
class LargestBends {
  public:
    /// Rows [y_begin, y_end) of the picture, which is that of `header` without its overscan.
    LargestBends(const SampleHeader& header, int y_begin, int y_end);
    /// Takes in the records of rows [y_begin, y_end) of `band`, in parallel; rows beyond its own do not
    /// count.
    void add(const RecordBand& band, int y_begin, int y_end);
    /// Whether it is of all these rows of the picture.
    [[nodiscard]] bool covers(int y_begin, int y_end) const { return y_begin >= y_begin_ && y_end <= y_end_; }
    /// Of a row of the picture, as wide as it.
    [[nodiscard]] const float* row(int y) const {
        return values_.data() + static_cast<std::size_t>(y - y_begin_) * static_cast<std::size_t>(width_);
    }

  private:
    int width_, y_begin_, y_end_;
    std::vector<float> values_;
};

}  // namespace postlens
