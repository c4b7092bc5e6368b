#include "focus/scatter.h"

#include <algorithm>
#include <vector>

#include "core/multiversion.h"
#include "core/threads.h"
#include "focus/point_scatter.h"
#include "focus/run_scatter.h"

namespace postlens {
namespace {

// What is being added to fits the second-level cache: twice the radius in rows of 16 B a pixel. Taller blocks
// share more filtered rows, wider ones more running sums; smaller ones keep more threads busy. Found with
// bench/scatter_bench.cpp.
constexpr int block_width = 128;
constexpr int block_height = 256;
/// PointScatter keeps 64 B a pixel and looks at every splat once for so many rows.
constexpr int point_rows = 8;

constexpr int strip_width = RunScatter::strip_width;

/// Sums of a strip of pixels, channel by channel.
struct Sums {
    double of[4][strip_width];
};

POSTLENS_MULTIVERSION
void normalise(const Sums& sums, bool may_be_negative, float (&rgb)[3][strip_width]) {
    for (int i = 0; i < strip_width; ++i) {
        const double weight = sums.of[3][i];
        const double scale = weight > smallest_weight ? 1 / weight : 0;
        for (int c = 0; c < 3; ++c) {
            const double value = sums.of[c][i] * scale;
            // Differences of sums leave the last bits of what was subtracted.
            rgb[c][i] = static_cast<float>(may_be_negative || value > 0 ? value : 0);
        }
    }
}

/// Rows [y_begin, y_end) of a block, at most point_rows.
class RowsOfBlock {
  public:
    RowsOfBlock(const SplatTables& tables, const RunScatter* runs, const RasterWindow& rows)
        : tables_(tables), runs_(runs), rows_(rows), points_(tables, rows), any_points_(points_.run()) {}

    void store(Image& image) const {
        const RasterWindow& picture = tables_.picture();
        const bool may_be_negative = false;
        for (int y = rows_.y_begin; y < rows_.y_end; ++y) {
            for (int x = rows_.x_begin; x < rows_.x_end; x += strip_width) {
                const int width = std::min(strip_width, rows_.x_end - x);
                float rgb[3][strip_width];
                normalise(sums_of(x, y, width), may_be_negative, rgb);
                float* out = image.pixel(x - picture.x_begin, y - picture.y_begin);
                for (int i = 0; i < width; ++i) {
                    for (int c = 0; c < 3; ++c) out[3 * i + c] = rgb[c][i];
                }
            }
        }
    }

  private:
    [[nodiscard]] Sums sums_of(int x, int y, int width) const {
        Sums sums{};
        if (runs_ != nullptr) {
            for (int c = 0; c < 4; ++c) {
                std::copy_n(runs_->sums(c, (x - rows_.x_begin) / strip_width, y), strip_width, sums.of[c]);
            }
        }
        if (any_points_) {
            const double* points = points_.sums(y) + 4 * (x - rows_.x_begin);
            for (int i = 0; i < width; ++i) {
                for (int c = 0; c < 4; ++c) sums.of[c][i] += points[4 * i + c];
            }
        }
        return sums;
    }

    const SplatTables& tables_;
    const RunScatter* runs_;
    RasterWindow rows_;
    PointScatter points_;
    bool any_points_;
};

}  // namespace

void scatter(const SplatTables& tables, Image& image) {
    const RasterWindow& picture = tables.picture();
    if (image.width != picture.width() || image.height != picture.height()) {
        image = Image(picture.width(), picture.height());
    }
    const int columns = (picture.width() + block_width - 1) / block_width;
    const int rows = (picture.height() + block_height - 1) / block_height;
    parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t i) {
        const int x = picture.x_begin + static_cast<int>(i) % columns * block_width;
        const int y = picture.y_begin + static_cast<int>(i) / columns * block_height;
        const RasterWindow block{x, std::min(x + block_width, picture.x_end), y,
                                 std::min(y + block_height, picture.y_end)};
        RunScatter runs(tables, block);
        const bool any_runs = runs.run();
        for (int first = block.y_begin; first < block.y_end; first += point_rows) {
            const RasterWindow part{block.x_begin, block.x_end, first, std::min(first + point_rows, block.y_end)};
            RowsOfBlock(tables, any_runs ? &runs : nullptr, part).store(image);
        }
    });
}

Image scatter_reference(const SplatTables& tables) {
    const RasterWindow& picture = tables.picture();
    const RasterWindow& source = tables.source();
    std::vector<double> sums(4 * static_cast<std::size_t>(picture.width()) * static_cast<std::size_t>(picture.height()));
    const auto add = [&](int x, int y, std::uint32_t kernel_number, const double (&value)[4]) {
        const Kernel& kernel = tables.kernels()[kernel_number];
        for (int dy = kernel.y_begin; dy < kernel.y_end(); ++dy) {
            if (y + dy < picture.y_begin || y + dy >= picture.y_end) continue;
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(dy - kernel.y_begin)];
            for (int dx = row.x_begin; dx < row.x_end; ++dx) {
                if (x + dx < picture.x_begin || x + dx >= picture.x_end) continue;
                const int skipped = dx < row.inner_begin ? row.x_begin : row.x_begin + row.inner_end - row.inner_begin;
                const double share = dx >= row.inner_begin && dx < row.inner_end
                                         ? static_cast<double>(kernel.inner)
                                         : static_cast<double>(kernel.taps[row.tap + static_cast<std::uint32_t>(dx - skipped)]);
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
                for (int c = 0; c < 3; ++c) value[c] = static_cast<double>(tables.raster_row(c, y)[x - source.x_begin]);
                add(x, y, run.kernel, value);
            }
        }
        for (const Splat& s : tables.row(y).splats) {
            add(s.x, y, s.kernel,
                {static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b),
                 static_cast<double>(s.weight)});
        }
    }
    Image image(picture.width(), picture.height());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const double* sum = sums.data() + i / 3 * 4;
        image.rgb[i] = static_cast<float>(sum[3] > smallest_weight ? sum[i % 3] / sum[3] : 0);
    }
    return image;
}

}  // namespace postlens
