#include "focus/largest_bends.h"

#include <algorithm>

#include "core/threads.h"

namespace postlens {

LargestBends::LargestBends(const SampleHeader& header, int y_begin, int y_end)
    : width_(header.width), y_begin_(y_begin), y_end_(y_end) {
    values_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(y_end - y_begin), 0.0F);
}

void LargestBends::add(const RecordBand& band, int y_begin, int y_end) {
    const int begin = std::max(y_begin, y_begin_), end = std::min(y_end, y_end_);
    if (begin >= end) return;
    parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
        const int y = begin + static_cast<int>(i);
        for (int x = 0; x < width_; ++x) {
            const std::size_t k = band.pixel(x, y);
            float most = 0;
            for (std::uint64_t n = band.offsets[k]; n < band.offsets[k + 1]; ++n) {
                const Record& r = band.records[n];
                if (r.layer == 0 && std::max({r.r, r.g, r.b}) > darkest_shown)
                    most = std::max(most, r.w_bend);
            }
            values_[static_cast<std::size_t>(y - y_begin_) * static_cast<std::size_t>(width_) +
                    static_cast<std::size_t>(x)] = most;
        }
    });
}

}  // namespace postlens
