#include "chart/atlas/recoloured.h"

#include <algorithm>

namespace postlens {
namespace {

float mean_around(const Image& image, int x, int y, std::size_t channel) {
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
        sum += image.pixel(std::clamp(x - (k & 1), 0, image.width - 1),
                           std::clamp(y - (k >> 1), 0, image.height - 1))[channel];
    }
    return sum / 4;
}

}  // namespace

void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path) {
    SampleHeader h = file.header();
    h.subdivide_levels = 0;
    h.has_layers = h.has_w = h.has_bend = h.has_marks = false;
    h.exposure_stops = image.exposure_stops.value_or(0);
    h.overscan_px = 0;
    h.key_times_s.clear();
    RecordBand from, to;
    file.read(0, h.height + 1, from);
    to.x_end = h.width + 1;
    to.y_end = h.height + 1;
    for (int y = 0; y <= h.height; ++y) {
        for (int x = 0; x <= h.width; ++x) {
            Record r = from.records[from.offsets[from.pixel(x, y)]];
            r.r = mean_around(image, x, y, 0);
            r.g = mean_around(image, x, y, 1);
            r.b = mean_around(image, x, y, 2);
            r.mark = 0;
            to.records.push_back(r);
            to.offsets.push_back(static_cast<std::uint32_t>(to.records.size()));
        }
    }
    SampleFileWriter writer(path, h, RecordCompression::none);
    writer.write(to);
    writer.finish();
}

}  // namespace postlens
