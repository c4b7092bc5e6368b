#include "motionblur/groups/band_surfaces.h"

#include <algorithm>

#include "core/memory.h"
#include "core/threads.h"

namespace postlens {

RecordBands::RecordBands(const SampleFileReader& file, std::size_t instant) : file_(file), instant_(instant) {
    for (int y = file.y_begin(); y < file.y_end() - 1; y += band_rows) {
        RecordBand band{
            file.x_begin(), file.x_end(), y, std::min(y + band_rows, file.y_end() - 1) + 1, {}, {}};
        bands_.push_back(std::move(band));
    }
}

void RecordBands::read(RecordBand& band) const {
    const int y_begin = band.y_begin, y_end = band.y_end;
    std::uint64_t records = 0;
    for (int y = y_begin; y < y_end; ++y)
        records += file_.scanlines(instant_)[static_cast<std::size_t>(y - file_.y_begin())].records;
    // Memory for the records (stored surface samples) of these rows. About 100 more bytes for each record are
    // needed later, when the records are converted to a quadtree and surfaces.
    require_memory(records * (sizeof(Record) + 100), "the records of the frame");
    file_.read(y_begin, y_end, band, instant_);
}

void RecordBands::read_all(const std::function<bool(const RecordBand&)>& keep) {
    RecordBand buffer;
    for (RecordBand& band : bands_) {
        buffer.y_begin = band.y_begin;
        buffer.y_end = band.y_end;
        read(buffer);
        if (keep(buffer)) {
            band = std::move(buffer);
            buffer = RecordBand();
        }
    }
}

void RecordBands::need(int y_begin, int y_end) {
    for (RecordBand& band : bands_) {
        if (band.y_end - 1 <= y_begin || band.y_begin >= y_end || band.offsets.size() > 1) continue;
        read(band);
    }
}

std::vector<BandSurfaces> band_surfaces(const std::vector<RecordBand>& bands, int y_begin, int y_end) {
    std::vector<BandSurfaces> out(bands.size());
    parallel_for(bands.size(), [&](std::size_t i) {
        const RecordBand& band = bands[i];
        BandSurfaces& s = out[i];
        s.x_begin = band.x_begin;
        s.width = band.width();
        s.y_begin = s.y_end = band.y_begin;
        if (band.y_end - 1 <= y_begin || band.y_begin >= y_end) return;
        s.y_end = band.y_end - 1;
        find_leaves(band, s.y_begin, s.y_end, s.leaves);
        find_surfaces(band, s.leaves.points, s.y_begin, s.surfaces);
    });
    return out;
}

GroupTable::GroupTable(const std::vector<MovingGroup>& groups) {
    constexpr std::uint32_t largest_small = 1U << 16U;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        for (const std::uint32_t id : groups[g].ids) {
            if (id < largest_small) {
                if (small_.size() <= id) small_.resize(id + 1, -1);
                small_[id] = static_cast<int>(g);
            } else {
                large_.emplace_back(id, static_cast<int>(g));
            }
        }
    }
    std::sort(large_.begin(), large_.end());
}

}  // namespace postlens
