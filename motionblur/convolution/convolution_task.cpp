#include "motionblur/convolution/convolution_task.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/memory.h"
#include "core/threads.h"

namespace postlens {
namespace {

constexpr CellWindow nothing{std::numeric_limits<int>::max(), std::numeric_limits<int>::min(),
                             std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};

void add(CellWindow& window, int y, const ColumnRange& columns) {
    if (columns.is_empty()) return;
    window = {std::min(window.x_begin, columns.begin), std::max(window.x_end, columns.end),
              std::min(window.y_begin, y), std::max(window.y_end, y + 1)};
}

/// Range of indices from the first to the last nonzero value.
template <typename T>
ColumnRange filled(const T* values, int count) {
    int begin = 0, end = count;
    while (begin < end && values[begin] == 0) ++begin;
    while (begin < end && values[end - 1] == 0) --end;
    return {begin, end};
}

}  // namespace

CellWindow window_of(const Planes& p) {
    return {p.x_begin, p.x_begin + p.width, p.y_begin, p.y_begin + p.height};
}

CellWindow window_of(const PathRaster& r) {
    return {r.x_begin, r.x_begin + r.width, r.y_begin, r.y_begin + r.height};
}

Planes zero_planes(const CellWindow& window, std::size_t count) {
    Planes out{window.x_begin, window.y_begin, window.width(), window.height(), {}};
    const auto cells = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
    require_memory(count * cells * sizeof(float), "convolution with a path");
    out.planes.resize(count);
    parallel_for(count, [&](std::size_t p) { out.planes[p].resize(cells); });
    return out;
}

CellWindow full_window(const CellWindow& a, const CellWindow& b) {
    return {a.x_begin + b.x_begin, a.x_end + b.x_end - 1, a.y_begin + b.y_begin, a.y_end + b.y_end - 1};
}

ConvolutionTask::ConvolutionTask(const Planes& a, const PathRaster& b, const CellWindow& wanted)
    : i1(a), i2(b), source(nothing), path(nothing), out{} {
    std::vector<ColumnRange> all(static_cast<std::size_t>(i1.height), {i1.width, 0});
    for (std::size_t plane = 0; plane < i1.planes.size(); ++plane) {
        assert(i1.planes[plane].size() == all.size() * static_cast<std::size_t>(i1.width));
        for (int y = 0; y < i1.height; ++y) {
            ColumnRange& columns = all[static_cast<std::size_t>(y)];
            const ColumnRange own = filled(row(plane, i1.y_begin + y) + i1.x_begin, i1.width);
            if (own.is_empty()) continue;
            columns = {std::min(columns.begin, own.begin), std::max(columns.end, own.end)};
        }
    }
    for (int y = 0; y < i1.height; ++y) {
        ColumnRange& columns = all[static_cast<std::size_t>(y)];
        columns = columns.is_empty() ? ColumnRange{}
                                     : ColumnRange{columns.begin + i1.x_begin, columns.end + i1.x_begin};
        add(source, y + i1.y_begin, columns);
    }
    for (int y = 0; y < i2.height; ++y) {
        const ColumnRange c = filled(
            i2.weight.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(i2.width), i2.width);
        if (!c.is_empty()) add(path, y + i2.y_begin, {c.begin + i2.x_begin, c.end + i2.x_begin});
    }
    if (source.x_begin >= source.x_end || path.x_begin >= path.x_end) return;
    rows.assign(all.begin() + (source.y_begin - i1.y_begin), all.begin() + (source.y_end - i1.y_begin));
    const CellWindow full = full_window(source, path);
    out = {std::max(full.x_begin, wanted.x_begin), std::min(full.x_end, wanted.x_end),
           std::max(full.y_begin, wanted.y_begin), std::min(full.y_end, wanted.y_end)};
}

}  // namespace postlens
