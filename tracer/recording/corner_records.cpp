#include "tracer/recording/corner_records.h"

#include <algorithm>
#include <cstddef>

#include "core/resize_to_overwrite.h"
#include "core/threads.h"
#include "records/record_check.h"

namespace postlens {

void CornerRecords::sort(const CornerGrid& grid, std::span<const CornerSample> samples, int y_begin,
                         int y_end) {
    y_begin_ = y_begin;
    const std::uint32_t end = grid.row(y_end);
    const auto pixel_of = [&](const CornerSample& s) {
        return static_cast<std::size_t>(grid.to_pixels(s.y - grid.row(y_begin))) *
                   static_cast<std::size_t>(grid.columns) +
               grid.to_pixels(s.x);
    };
    const std::size_t pixels =
        static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(grid.columns);
    first_.assign(pixels + 1, 0);
    first_record_.assign(pixels + 1, 0);
    for (const CornerSample& s : samples) {
        if (s.y >= end) continue;
        ++first_[pixel_of(s) + 1];
        first_record_[pixel_of(s) + 1] += s.count;
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        first_[i + 1] += first_[i];
        first_record_[i + 1] += first_record_[i];
    }
    order_.resize(first_.back());
    next_.assign(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        if (samples[i].y < end) order_[next_[pixel_of(samples[i])]++] = i;
    }
}

void CornerRecords::emit(const CornerGrid& grid, std::span<const CornerSample> samples,
                         const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out) {
    out.x_begin = grid.window.x_begin;
    out.x_end = grid.window.x_end + 1;
    out.y_begin = y_begin;
    out.y_end = y_end;
    const std::size_t first_pixel = static_cast<std::size_t>(y_begin - y_begin_) *
                                    static_cast<std::size_t>(grid.columns),
                      pixels =
                          static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(grid.columns);
    const std::uint32_t* const first_record = first_record_.data() + first_pixel;
    out.offsets.resize(pixels + 1);
    for (std::size_t i = 0; i <= pixels; ++i) out.offsets[i] = first_record[i] - first_record[0];
    resize_to_overwrite(out.records, out.offsets.back());
    parallel_for(
        pixels,
        [&](std::size_t p) {
            const auto a = order_.begin() + first_[first_pixel + p],
                       b = order_.begin() + first_[first_pixel + p + 1];
            if (b - a > 1) {
                std::sort(a, b, [&](std::uint32_t i, std::uint32_t k) {
                    return CornerGrid::key(samples[i].x, samples[i].y) <
                           CornerGrid::key(samples[k].x, samples[k].y);
                });
            }
            Record* to = out.records.data() + out.offsets[p];
            for (auto i = a; i != b; ++i) {
                const CornerSample& s = samples[*i];
                to = std::copy_n(chunks[s.chunk].records.data() + s.first, s.visible, to);
            }
            Record* const hidden = to;
            for (auto i = a; i != b; ++i) {
                const CornerSample& s = samples[*i];
                to = std::copy_n(chunks[s.chunk].records.data() + s.first + s.visible, s.count - s.visible,
                                 to);
            }
            std::sort(hidden, to, canonical_before);
        },
        1024);
}

}  // namespace postlens
