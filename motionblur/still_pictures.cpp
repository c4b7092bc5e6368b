#include "motionblur/still_pictures.h"

#include <algorithm>

#include "core/threads.h"
#include "records/quadtree.h"

namespace postlens {
namespace {

/// Adds the colours of one recorded instant to a mean over several instants. For each pixel of `band`, adds
/// its colour times `share`, the instant's weight, to `sum`, and adds `share` to `weight`. Skips pixels that
/// are marked in `hidden`, because a moving object covers them.
void add_band(const SampleHeader& header, const RecordBand& band, double share,
              const std::vector<std::uint8_t>& hidden, std::vector<double>& sum,
              std::vector<double>& weight) {
    const int y_begin = std::max(0, band.y_begin), y_end = std::min(header.height, band.y_end - 1);
    const auto width = static_cast<std::size_t>(header.width);
    parallel_for(static_cast<std::size_t>(std::max(0, y_end - y_begin)), [&](std::size_t i) {
        const int y = y_begin + static_cast<int>(i);
        std::vector<float> row(3 * width);
        picture_row(band, y, 0, header.width, row);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t k = static_cast<std::size_t>(y) * width + x;
            if (hidden[k] != 0) continue;
            weight[k] += share;
            for (std::size_t c = 0; c < 3; ++c) sum[3 * k + c] += share * static_cast<double>(row[3 * x + c]);
        }
    });
}

}  // namespace

std::vector<std::uint8_t> pixels_showing(const SampleHeader& header, const std::vector<RecordBand>& bands,
                                         const std::vector<std::uint32_t>& ids) {
    const auto width = static_cast<std::size_t>(header.width);
    std::vector<std::uint8_t> out(width * static_cast<std::size_t>(header.height), 0);
    const auto shows = [&](const RecordBand& band, int x, int y) {
        const std::size_t k = band.pixel(x, y);
        for (std::uint32_t i = band.offsets[k]; i < band.offsets[k + 1]; ++i) {
            const Record& r = band.records[i];
            if (r.layer == 0 && r.path.bits() == 0 && std::binary_search(ids.begin(), ids.end(), r.id))
                return true;
        }
        return false;
    };
    parallel_for(bands.size(), [&](std::size_t b) {
        const RecordBand& band = bands[b];
        if (band.offsets.size() <= 1) return;  // the band is not in memory, because nothing moves in it
        for (int y = std::max(0, band.y_begin); y < std::min(header.height, band.y_end - 1); ++y) {
            for (int x = 0; x < header.width; ++x) {
                // A pixel stores only the samples at its upper left corner and inside it. The samples at its
                // other corners are stored with its neighbours to the right, below, and below right.
                out[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] =
                    shows(band, x, y) || shows(band, x + 1, y) || shows(band, x, y + 1) ||
                            shows(band, x + 1, y + 1)
                        ? 1
                        : 0;
            }
        }
    });
    return out;
}

void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image) {
    const SampleHeader& header = file.header();
    std::vector<double> sum(image.rgb.size(), 0), weight(touched.size(), 0);
    for (std::size_t i = 0; i < shares.size(); ++i) {
        if (shares[i] == 0) continue;
        RecordBands(file, i).read_all([&](const RecordBand& band) {
            add_band(header, band, shares[i], pixels_showing(header, {band}, elsewhere), sum, weight);
            return false;
        });
    }
    for (std::size_t k = 0; k < touched.size(); ++k) {
        if (touched[k] != 0 || weight[k] <= 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            image.rgb[3 * k + c] = static_cast<float>(sum[3 * k + c] / weight[k]);
    }
}

}  // namespace postlens
