#include "apps/view/image_depths.h"

#include <algorithm>
#include <array>

#include "core/threads.h"
#include "pictures/srgb.h"
#include "tracer/shading_trees/lens_reach.h"

namespace postlens {
namespace {

double brightness(const Record& record) {
    return exact_luminance(std::array<float, 3>{record.r, record.g, record.b}.data());
}

const Record* brightest(const RecordBand& band, int x, int y) {
    const std::size_t k = band.pixel(x, y);
    const Record* best = nullptr;
    for (std::uint32_t i = band.offsets[k]; i < band.offsets[k + 1]; ++i) {
        const Record& r = band.records[i];
        if (r.layer == 0 && (best == nullptr || brightness(r) > brightness(*best))) best = &r;
    }
    return best;
}

ImageDepths all_infinitely_far(int width, int height) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return {std::vector<float>(pixels), std::vector<std::uint32_t>(pixels)};
}

}  // namespace

ImageDepths image_depths(const SampleFileReader& file) {
    const int width = file.header().width, height = file.header().height;
    const auto columns = static_cast<std::size_t>(width);
    ImageDepths out = all_infinitely_far(width, height);
    constexpr int rows_at_once = 64;
    RecordBand band;
    for (int first = 0; first < height; first += rows_at_once) {
        const int end = std::min(height, first + rows_at_once);
        file.read(first, end, band);
        parallel_for(static_cast<std::size_t>(end - first), [&](std::size_t row) {
            const int y = first + static_cast<int>(row);
            for (int x = 0; x < width; ++x) {
                const Record* best = brightest(band, x, y);
                if (best == nullptr) continue;
                const std::size_t at = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
                out.inverse_per_m[at] = static_cast<float>(LensReach::inverse_depth(best->w));
                out.ids[at] = best->id;
            }
        });
    }
    return out;
}

ImageDepths image_depths(const ForeignPicture& picture) {
    ImageDepths out = all_infinitely_far(picture.width, picture.height);
    parallel_for(static_cast<std::size_t>(picture.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < picture.width; ++x) {
            const StackSample* seen = picture.stores(x, y) ? picture.seen_sample(x, y) : nullptr;
            if (seen == nullptr) continue;
            const std::size_t at =
                row * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
            out.inverse_per_m[at] = seen->inverse_z;
            out.ids[at] = seen->id;
        }
    });
    return out;
}

}  // namespace postlens
