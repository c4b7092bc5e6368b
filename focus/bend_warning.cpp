#include "focus/bend_warning.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "core/threads.h"

namespace postlens {
namespace {

constexpr int rows_per_band = 64;
constexpr double most_px = 0.5;
constexpr float darkest = 1.0F / 255;  // what is darker no eight-bit picture shows

}  // namespace

std::optional<FocusWarning> bend_warning(const SampleFileReader& file, const FocusGeometry& lens) {
    const SampleHeader& h = file.header();
    const double px_per_bend = lens.gain_px * lens.aperture_radius_m * lens.aperture_radius_m;
    if (!h.has_bend || !(px_per_bend > 0)) return std::nullopt;
    const auto is_misplaced = [&](const Record& r) {
        return r.layer == 0 && std::max({r.r, r.g, r.b}) > darkest &&
               px_per_bend * static_cast<double>(r.w_bend) > most_px;
    };
    std::vector<int> misplaced(static_cast<std::size_t>(h.height), 0);
    RecordBand band;
    for (int begin = 0; begin < h.height; begin += rows_per_band) {
        const int end = std::min(begin + rows_per_band, h.height);
        file.read(begin, end, band);
        parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
            const int y = begin + static_cast<int>(i);
            for (int x = 0; x < h.width; ++x) {
                const std::size_t k = band.pixel(x, y);
                if (std::any_of(band.records.begin() + band.offsets[k],
                                band.records.begin() + band.offsets[k + 1], is_misplaced))
                    ++misplaced[static_cast<std::size_t>(y)];
            }
        });
    }
    double pixels = 0;
    for (const int of_row : misplaced) pixels += of_row;
    if (pixels == 0) return std::nullopt;
    const double share = pixels / h.width / h.height;
    return FocusWarning{
        .code = "nonlinear",
        .share = share,
        .text = fmt::format("{:.1f} % of the pixels show something in a mirror or in glass that other points "
                            "of the lens see more than {} px from where its W puts it, or not at all",
                            100 * share, most_px)};
}

}  // namespace postlens
