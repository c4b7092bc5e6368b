#include "records/pixel_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "records/quadtree.h"

namespace postlens {

namespace {

// Adds the records of hidden surfaces to `sample`, which already contains the surfaces that the pinhole sees
// at its position. Records of hidden surfaces have `layer` > 0 and the same position. `band` stores all
// records of a position in the pixel that contains this position.
void add_hidden(const RecordBand& band, PixelSample& sample) {
    const std::size_t k =
        band.pixel(static_cast<int>(std::floor(sample.x)), static_cast<int>(std::floor(sample.y)));
    for (std::uint32_t i = band.offsets[k]; i < band.offsets[k + 1]; ++i) {
        const Record& r = band.records[i];
        if (r.layer > 0 && r.x == sample.x && r.y == sample.y) sample.nodes.push_back(r);
    }
}

}  // namespace

std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y, std::size_t instant) {
    if (x < file.x_begin() || y < file.y_begin() || x >= file.x_end() - 1 || y >= file.y_end() - 1) {
        fail(ExitCode::wrong_arguments, "--at: outside the picture (got {},{}; expected {}..{},{}..{})", x, y,
             file.x_begin(), file.x_end() - 2, file.y_begin(), file.y_end() - 2);
    }
    RecordBand band;
    file.read(y, y + 2, band, instant);
    PointSamples found;
    find_point_samples(band, y, y + 2, y, y + 1, found);
    std::vector<PixelSample> out;
    for (const PointSample& s : found.samples) {
        // Computes the weight of the sample s in this pixel's colour. s is a corner of up to four quadtree
        // cells, some of which may lie in neighbouring pixels. Each cell in this pixel adds a quarter of its
        // area to the weight.
        double weight = 0;
        for (int q = 0; q < 4; ++q) {
            const auto i = static_cast<std::size_t>(q);
            const double half = static_cast<double>(s.leaf_size[i]) / 2;
            if (half == 0) continue;
            const double px = static_cast<double>(s.x) + (q % 2 == 0 ? -half : half);
            const double py = static_cast<double>(s.y) + (q / 2 == 0 ? -half : half);
            if (std::floor(px) == x && std::floor(py) == y) weight += static_cast<double>(s.weight[i]);
        }
        if (weight == 0) continue;
        const auto first = band.records.begin() + s.first_record;
        out.push_back({s.x, s.y, weight, {first, first + s.record_count}});
        add_hidden(band, out.back());
    }
    std::sort(out.begin(), out.end(),
              [](const PixelSample& a, const PixelSample& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    return out;
}

double depth_at(const SampleFileReader& file, double x, double y) {
    const auto inside = [](double v, int low, int high) {
        return std::clamp(static_cast<int>(std::floor(v)), low, high - 2);
    };
    const SampleHeader& h = file.header();
    if (!(x >= 0 && y >= 0 && x <= h.width && y <= h.height)) {
        fail(ExitCode::wrong_arguments, "--focus-at: outside the picture (got {},{}; expected 0..{},0..{})",
             x, y, h.width, h.height);
    }
    double nearest = std::numeric_limits<double>::infinity(), depth = nearest;
    for (const PixelSample& s : pixel_samples(file, inside(x, file.x_begin(), file.x_end()),
                                              inside(y, file.y_begin(), file.y_end()))) {
        const double distance = std::hypot(static_cast<double>(s.x) - x, static_cast<double>(s.y) - y);
        if (distance >= nearest) continue;
        nearest = distance;
        depth = static_cast<double>(s.nodes.front().z);
    }
    return depth;
}

}  // namespace postlens
