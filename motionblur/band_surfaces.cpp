#include "motionblur/band_surfaces.h"

#include <algorithm>

#include "core/memory.h"
#include "core/threads.h"

namespace postlens {

std::vector<RecordBand> read_bands(const SampleFileReader& file, std::size_t instant) {
    // The records, and what is made of them: samples, leaves and surfaces.
    require_memory(file.record_count() * (sizeof(Record) + 100), "the records of the frame");
    std::vector<RecordBand> bands;
    for (int y = file.y_begin(); y < file.y_end() - 1; y += band_rows) {
        bands.emplace_back();
        file.read(y, std::min(y + band_rows, file.y_end() - 1) + 1, bands.back(), instant);
    }
    return bands;
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
