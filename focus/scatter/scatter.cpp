#include "focus/scatter/scatter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tbb/enumerable_thread_specific.h>
#include <vector>

#include "core/multiversion.h"
#include "core/progress.h"
#include "core/threads.h"
#include "focus/scatter/point_scatter.h"
#include "focus/scatter/run_scatter.h"

namespace postlens {
namespace {

// Size, in px, of the blocks of the image that threads compute, chosen by measurement
// (bench/scatter_bench.cpp). A block's rows should fit into the L2 cache. Larger blocks share more work,
// smaller ones keep more threads busy.
constexpr int block_width = scatter_block_px;
constexpr int block_height = scatter_block_px;
/// Number of pixel rows that PointScatter computes at a time. More rows need more memory, 64 B per pixel.
/// Fewer rows need more time, because the samples whose blur reaches the rows are searched for every group of
/// rows.
constexpr int point_rows = 32;

constexpr int strip_width = RunScatter::strip_width;

/// Four arrays for one row of a strip of the image, which is strip_width pixels wide. They contain, for each
/// pixel, the sum of the red, the green and the blue of all blurred samples, and the sum of the samples'
/// weights.
using Sums = std::array<const double*, 4>;

/// Returns the number by which a pixel's sum of colours is divided: the sum of the samples' weights,
/// `weight`, and the weight of empty (black) space. Empty space fills the rest up to 1, but at most the
/// fraction `most_nothing` of the pixel.
double filled(double weight, float most_nothing) {
    return weight + std::min(static_cast<double>(most_nothing), std::max(1 - weight, 0.0));
}

POSTLENS_MULTIVERSION
void normalise(const Sums& sums, const float* __restrict nothing, bool may_be_negative,
               float* __restrict rgb) {
    const double* __restrict r = sums[0];
    const double* __restrict g = sums[1];
    const double* __restrict b = sums[2];
    const double* __restrict weight = sums[3];
    // Rounding errors may make a value slightly negative, so it is clamped to 0, unless the scene has
    // negative colours.
    const double least = may_be_negative ? -std::numeric_limits<double>::infinity() : 0;
    for (int i = 0; i < strip_width; ++i) {
        const double scale = weight[i] > smallest_weight ? 1 / filled(weight[i], nothing[i]) : 0;
        rgb[3 * i] = static_cast<float>(std::max(r[i] * scale, least));
        rgb[3 * i + 1] = static_cast<float>(std::max(g[i] * scale, least));
        rgb[3 * i + 2] = static_cast<float>(std::max(b[i] * scale, least));
    }
}

/// Computes one colour channel of the image, and stores it in `image`. Each pixel's sum of colours is divided
/// by its sum of the samples' weights. This function is used if each colour channel has its own blur kernels.
void store_channel(const SplatTables& tables, const PointScatter& points, std::size_t channel,
                   const RasterWindow& rows, Image& image) {
    const RasterWindow& picture = tables.picture();
    for (int y = rows.y_begin; y < rows.y_end; ++y) {
        const float* nothing = tables.nothing_row(y);
        for (int x = rows.x_begin; x < rows.x_end; ++x) {
            const bool reached =
                points.reaches(y) && x >= points.reached().x_begin && x < points.reached().x_end;
            const double* sums = reached ? points.sums(x, y) : nullptr;
            const float most = nothing != nullptr ? nothing[x - picture.x_begin] : 0;
            const double value =
                sums != nullptr && sums[3] > smallest_weight ? sums[channel] / filled(sums[3], most) : 0;
            image.pixel(x - picture.x_begin, y - picture.y_begin)[channel] =
                static_cast<float>(tables.any_negative() ? value : std::max(value, 0.0));
        }
    }
}

/// Computes a few pixel rows, and stores them in `image`. Each pixel's sums of colours are divided by its sum
/// of weights. `points` contains the sums of samples that were blurred one by one. `runs` contains those of
/// adjacent samples that were blurred together; it may be null.
void store_rows(const SplatTables& tables, const RunScatter* runs, const PointScatter& points,
                const RasterWindow& rows, Image& image) {
    static constexpr std::array<double, strip_width> none{};
    const RasterWindow& picture = tables.picture();
    const bool vignettes = tables.responses().model().varies_over_field();
    for (int y = rows.y_begin; y < rows.y_end; ++y) {
        const float* nothing = tables.nothing_row(y);
        for (int x = rows.x_begin; x < rows.x_end; x += strip_width) {
            const int width = std::min(strip_width, rows.x_end - x);
            Sums sums{};
            for (int c = 0; c < 4; ++c) {
                sums[static_cast<std::size_t>(c)] =
                    runs != nullptr ? runs->sums(c, (x - rows.x_begin) / strip_width, y) : none.data();
            }
            // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): filled where it is used
            std::array<std::array<double, strip_width>, 4> both;
            const int first = std::max(x, points.reached().x_begin),
                      last = std::min(x + width, points.reached().x_end);
            if (points.reaches(y) && first < last) {
                const double* from = points.sums(first, y);
                const auto begin = static_cast<std::size_t>(first - x),
                           count = static_cast<std::size_t>(last - first);
                for (std::size_t c = 0; c < 4; ++c) {
                    std::copy_n(sums[c], strip_width, both[c].data());
                    for (std::size_t i = 0; i < count; ++i) both[c][begin + i] += from[4 * i + c];
                    sums[c] = both[c].data();
                }
            }
            std::array<double, strip_width> open{};
            if (vignettes) {
                for (std::size_t i = 0; i < strip_width; ++i) {
                    open[i] = tables.responses().open_share(picture, x + static_cast<int>(i), y);
                    for (std::size_t c = 0; c < 4; ++c) both[c][i] = open[i] > 0 ? sums[c][i] / open[i] : 0;
                }
                for (std::size_t c = 0; c < 4; ++c) sums[c] = both[c].data();
            }
            std::array<float, strip_width> most_nothing{};
            if (nothing != nullptr) std::copy_n(nothing + (x - picture.x_begin), width, most_nothing.data());
            float* out = image.pixel(x - picture.x_begin, y - picture.y_begin);
            if (width == strip_width) {
                normalise(sums, most_nothing.data(), tables.any_negative(), out);
            } else {
                // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): filled whole
                std::array<float, 3 * strip_width> rgb;
                normalise(sums, most_nothing.data(), tables.any_negative(), rgb.data());
                std::copy_n(rgb.data(), 3 * width, out);
            }
            for (int i = 0; vignettes && i < 3 * width; ++i)
                out[i] *= static_cast<float>(open[static_cast<std::size_t>(i / 3)]);
        }
    }
}

}  // namespace

void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted) {
    const RasterWindow& picture = tables.picture();
    if (image.width != picture.width() || image.height != picture.height()) {
        image = Image(picture.width(), picture.height());
    }
    tbb::enumerable_thread_specific<RunScatter> run_scatters([&] { return RunScatter(tables); });
    using PointScatters = std::array<PointScatter, 3>;
    tbb::enumerable_thread_specific<PointScatters> point_scatters([&] {
        return PointScatters{PointScatter(tables, 0), PointScatter(tables, 1), PointScatter(tables, 2)};
    });
    const int columns = (picture.width() + block_width - 1) / block_width;
    const int rows = (picture.height() + block_height - 1) / block_height;
    const std::size_t blocks = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    Progress progress("scatter", blocks);
    parallel_for(blocks, [&](std::size_t i) {
        progress.advance();
        const int x = picture.x_begin + static_cast<int>(i) % columns * block_width;
        const int y = picture.y_begin + static_cast<int>(i) / columns * block_height;
        const RasterWindow block{x, std::min(x + block_width, picture.x_end), y,
                                 std::min(y + block_height, picture.y_end)};
        if (wanted && !wanted->meets(x - picture.x_begin, y - picture.y_begin, block.width(), block.height()))
            return;
        RunScatter& runs = run_scatters.local();
        const bool any_runs = runs.run(block);
        for (int first = block.y_begin; first < block.y_end; first += point_rows) {
            const RasterWindow part{block.x_begin, block.x_end, first,
                                    std::min(first + point_rows, block.y_end)};
            PointScatters& by_channel = point_scatters.local();
            if (tables.kernels().channels() == 3) {
                for (std::size_t c = 0; c < 3; ++c) {
                    by_channel[c].run(part);
                    store_channel(tables, by_channel[c], c, part, image);
                }
                continue;
            }
            PointScatter& points = by_channel[0];
            points.run(part);
            store_rows(tables, any_runs ? &runs : nullptr, points, part, image);
        }
    });
}

namespace {

/// Blurs every sample with the kernels of the colour channel `channel`. Returns four sums for every pixel,
/// over all samples: of red, green, blue and weight. If the colour channels have different kernels, only the
/// sums of colour `channel` and of the weight are valid.
std::vector<double> reference_sums(const SplatTables& tables, std::size_t channel) {
    const RasterWindow& picture = tables.picture();
    const RasterWindow& source = tables.source();
    std::vector<double> sums(4 * static_cast<std::size_t>(picture.width()) *
                             static_cast<std::size_t>(picture.height()));
    const auto add = [&](int x, int y, std::uint32_t kernel_number, const double(&value)[4]) {
        const Kernel& kernel = tables.kernels().kernel(kernel_number, channel);
        for (int dy = kernel.y_begin; dy < kernel.y_end(); ++dy) {
            if (y + dy < picture.y_begin || y + dy >= picture.y_end) continue;
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(dy - kernel.y_begin)];
            for (int dx = row.x_begin; dx < row.x_end; ++dx) {
                if (x + dx < picture.x_begin || x + dx >= picture.x_end) continue;
                const int skipped =
                    dx < row.inner_begin ? row.x_begin : row.x_begin + row.inner_end - row.inner_begin;
                const double share =
                    dx >= row.inner_begin && dx < row.inner_end
                        ? static_cast<double>(kernel.inner)
                        : static_cast<double>(
                              kernel.taps[row.tap + static_cast<std::uint32_t>(dx - skipped)]);
                const std::size_t at = static_cast<std::size_t>(y + dy - picture.y_begin) *
                                           static_cast<std::size_t>(picture.width()) +
                                       static_cast<std::size_t>(x + dx - picture.x_begin);
                for (std::size_t c = 0; c < 4; ++c) sums[4 * at + c] += share * value[c];
            }
        }
    };
    for (int y = source.y_begin; y < source.y_end; ++y) {
        for (const SplatRun& run : tables.row(y).runs) {
            for (int x = run.begin; x < run.end; ++x) {
                double value[4] = {0, 0, 0, 1};
                for (int c = 0; c < 3; ++c)
                    value[c] = static_cast<double>(tables.raster_row(c, y)[x - source.x_begin]);
                add(x, y, run.kernel, value);
            }
        }
        for (const Splat& s : tables.row(y).splats) {
            add(s.x, y, s.kernel,
                {static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b),
                 static_cast<double>(s.weight)});
        }
    }
    return sums;
}

}  // namespace

Image scatter_reference(const SplatTables& tables) {
    Image image(tables.picture().width(), tables.picture().height());
    const float* nothing = tables.nothing_row(tables.picture().y_begin);
    for (std::size_t channel = 0; channel < tables.kernels().channels(); ++channel) {
        const std::vector<double> sums = reference_sums(tables, channel);
        for (std::size_t i = 0; i < image.rgb.size(); ++i) {
            if (tables.kernels().channels() == 3 && i % 3 != channel) continue;
            const double* sum = sums.data() + i / 3 * 4;
            const float most = nothing != nullptr ? nothing[i / 3] : 0;
            image.rgb[i] =
                static_cast<float>(sum[3] > smallest_weight ? sum[i % 3] / filled(sum[3], most) : 0);
        }
    }
    return image;
}

}  // namespace postlens
