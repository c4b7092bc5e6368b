#include "tracer/recording/corner_records.h"

#include <algorithm>
#include <cstddef>

#include "core/resize_to_overwrite.h"
#include "core/threads.h"
#include "records/record_check.h"

namespace postlens {

void CornerRecords::emit(const CornerGrid& grid, std::span<const CornerSample> samples,
                         const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out) {
    out.x_begin = grid.window.x_begin;
    out.x_end = grid.window.x_end + 1;
    out.y_begin = y_begin;
    out.y_end = y_end;
    const std::uint32_t end = grid.row(y_end);
    const auto pixel_of = [&](const CornerSample& s) {
        return static_cast<std::size_t>(grid.to_pixels(s.y - grid.row(y_begin))) *
                   static_cast<std::size_t>(grid.columns) +
               grid.to_pixels(s.x);
    };
    const std::size_t pixels =
        static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(grid.columns);
    // Counts the samples and records of each pixel. A sample file is sorted by pixel, so these numbers
    // determine where each pixel begins.
    std::vector<std::uint32_t>& first = first_;
    first.assign(pixels + 1, 0);
    out.offsets.assign(pixels + 1, 0);
    for (const CornerSample& s : samples) {
        if (s.y >= end) continue;
        ++first[pixel_of(s) + 1];
        out.offsets[pixel_of(s) + 1] += s.count;
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        first[i + 1] += first[i];
        out.offsets[i + 1] += out.offsets[i];
    }
    std::vector<std::uint32_t>&order = order_, &next = next_;
    order.resize(first.back());
    next.assign(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        if (samples[i].y < end) order[next[pixel_of(samples[i])]++] = i;
    }
    resize_to_overwrite(out.records, out.offsets.back());
    parallel_for(
        pixels,
        [&](std::size_t p) {
            const auto a = order.begin() + first[p], b = order.begin() + first[p + 1];
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
        4096);
}

}  // namespace postlens
