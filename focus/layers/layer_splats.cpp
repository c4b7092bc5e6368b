#include "focus/layers/layer_splats.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tbb/enumerable_thread_specific.h>

#include "core/threads.h"
#include "focus/layers/layer_row_builder.h"

namespace postlens {
namespace {

/// Width, in px, of the squares in which samples are grouped. When a block of the image is computed, groups
/// whose blur does not reach the block are skipped.
constexpr int tile_px = 64;

}  // namespace

RadianceRange::RadianceRange() {
    least.fill(std::numeric_limits<float>::infinity());
    most.fill(-std::numeric_limits<float>::infinity());
}

void RadianceRange::include(const std::array<float, 3>& rgb) {
    for (std::size_t c = 0; c < 3; ++c) {
        least[c] = std::min(least[c], rgb[c]);
        most[c] = std::max(most[c], rgb[c]);
    }
}

void RadianceRange::include(const RadianceRange& other) {
    include(other.least);
    include(other.most);
}

struct LayerSplats::Builders {
    explicit Builders(LayerSplats& splats) : of_thread([&splats] { return RowBuilder(splats); }) {}
    tbb::enumerable_thread_specific<RowBuilder> of_thread;
};

LayerSplats::~LayerSplats() = default;

void LayerSplats::add_pixels(int y, std::span<const PixelLight> lights) {
    builders_->of_thread.local().build(lights, y);
}

LayerSplats::LayerSplats(const RasterWindow& source, const RasterWindow& picture,
                         const FocusGeometry& geometry, const DepthLevels& levels, DepthModel model,
                         std::shared_ptr<const ResponseModel> response)
    : source_(source),
      picture_(picture),
      responses_(geometry, levels, model, response ? std::move(response) : std::make_shared<ResponseModel>()),
      kernels_(levels.radius_px(), kernel_reach(source, picture), responses_.model()),
      builders_(std::make_unique<Builders>(*this)),
      border_(source),
      rows_(static_cast<std::size_t>(source.height())) {}

void LayerSplats::add_rows(const FrameRows& rows) {
    constexpr int step = FrameRows::rows_per_task;
    const RecordBand& band = *rows.band;
    const auto tasks = static_cast<std::size_t>((rows.y_end - rows.y_begin + step - 1) / step);
    parallel_for(tasks, [&](std::size_t task) {
        const int first = rows.y_begin + static_cast<int>(task) * step;
        const int last = std::min(first + step, rows.y_end);
        PointSamples found;
        if (rows.samples.empty())
            find_point_samples(band, first, last, source_.y_begin, source_.y_end - 1, found);
        const PointSamples& samples = rows.samples.empty() ? found : rows.samples[task];
        RowBuilder builder(*this);
        for (int y = first; y < last; ++y) {
            builder.build(band, samples,
                          static_cast<std::size_t>(y - first) * static_cast<std::size_t>(band.width()), y);
        }
    });
    if (keep_ != Keep::strip) return;
    strip_rows_.settle();
    join_rows(static_cast<std::size_t>(rows.y_end - source_.y_begin) / tile_px);
}

void LayerSplats::UnsortedRow::clear() {
    parts.clear();
    part.clear();
    splats.clear();
    largest_radius_px = 0;
    colours = {};
}

void LayerSplats::store(int y, UnsortedRow& made) {
    const auto index = static_cast<std::size_t>(y - source_.y_begin);
    if (index < joined_ * tile_px) return;  // the row was already added as part of an earlier range of rows
    if (keep_ == Keep::none) {
        made.splats.clear();
        made.part.clear();
    }
    if (keep_ == Keep::strip) {
        strip_rows_.begin_row(y);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < made.splats.size(); ++i) {
            const RasterWindow reach = reach_of(made.splats[i]);
            strip_rows_.add(y, {made.parts[made.part[i]], made.splats[i]}, reach.y_begin, reach.y_end);
            if (!meet(reach, strip_)) continue;
            made.splats[kept] = made.splats[i];
            made.part[kept++] = made.part[i];
        }
        made.splats.resize(kept);
        made.part.resize(kept);
    }
    rows_[index] = sorted(made);
}

// Sorts the samples of a row by surface, then by square of 64 x 64 px.
LayerSplats::Row LayerSplats::sorted(const UnsortedRow& row) const {
    Row out{row.parts, {}, {}, row.largest_radius_px, row.colours};
    const auto tiles = static_cast<std::uint32_t>((source_.width() + tile_px - 1) / tile_px);
    const auto bucket_of = [&](std::size_t i) {
        const auto tile = static_cast<std::uint32_t>((row.splats[i].x - source_.x_begin) / tile_px);
        return static_cast<std::size_t>(row.part[i]) * tiles + tile;
    };
    std::vector<std::uint32_t> begin(row.parts.size() * tiles + 1);
    for (std::size_t i = 0; i < row.splats.size(); ++i) ++begin[bucket_of(i) + 1];
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
        if (begin[i] == begin[i + 1]) continue;
        out.runs.push_back({static_cast<std::uint32_t>(i / tiles),
                            static_cast<std::uint32_t>(i % tiles),
                            {0, begin[i], begin[i + 1]}});
    }
    out.splats.resize(row.splats.size());
    for (std::size_t i = 0; i < row.splats.size(); ++i) out.splats[begin[bucket_of(i)]++] = row.splats[i];
    return out;
}

RasterWindow LayerSplats::reach_of(const LayerSplat& s) const {
    const Reach& r = kernels_.reach(s.kernel);
    return {s.x + r.dx_begin, s.x + r.dx_end, s.y + r.dy_begin, s.y + r.dy_end};
}

void LayerSplats::find_reach(LayerCell& cell) const {
    bool first = true;
    for (const LayerRun& run : runs(cell)) {
        for (const LayerSplat& s : splats(run)) {
            cell.reach = first ? reach_of(s) : around(cell.reach, reach_of(s));
            first = false;
        }
    }
}

// For one row of squares of 64 x 64 px, collects the samples of each surface in each square.
std::vector<LayerCell> LayerSplats::join(std::size_t tile_row) {
    const std::size_t first_row = tile_row * tile_px, last_row = std::min(first_row + tile_px, rows_.size());
    std::vector<PlacedRun> placed;
    for (std::size_t row = first_row; row < last_row; ++row) {
        for (PlacedRun run : rows_[row].runs) {
            const LayerPart& part = rows_[row].parts[run.part];
            run.part = static_cast<std::uint32_t>(std::lower_bound(parts_.begin(), parts_.end(), part) -
                                                  parts_.begin());
            run.run.row = static_cast<std::uint32_t>(row);
            placed.push_back(run);
        }
    }
    std::sort(placed.begin(), placed.end(),
              [](const PlacedRun& a, const PlacedRun& b) { return a.place() < b.place(); });
    std::vector<LayerRun>& runs = tile_runs_[tile_row];
    std::vector<LayerCell> cells;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const PlacedRun& r = placed[i];
        const auto at = static_cast<std::uint32_t>(i);
        if (i == 0 || r.part != placed[i - 1].part || r.tile != placed[i - 1].tile)
            cells.push_back({r.part, static_cast<std::uint32_t>(tile_row), at, at, {}});
        runs.push_back(r.run);
        ++cells.back().end;
    }
    for (LayerCell& cell : cells) find_reach(cell);
    return cells;
}

void LayerSplats::join_rows(std::size_t end) {
    if (end <= joined_) return;
    const std::size_t first = joined_;
    parallel_for(end - first, [&](std::size_t i) { tile_cells_[first + i] = join(first + i); });
    joined_ = end;
}

void LayerSplats::sort_cells() {
    cells_.clear();
    for (const auto& some : tile_cells_) cells_.insert(cells_.end(), some.begin(), some.end());
    tile_cells_.clear();
    std::stable_sort(cells_.begin(), cells_.end(),
                     [](const LayerCell& a, const LayerCell& b) { return a.part < b.part; });
}

void LayerSplats::begin_tile_rows() {
    const std::size_t count = (static_cast<std::size_t>(source_.height()) + tile_px - 1) / tile_px;
    joined_ = 0;
    tile_runs_.clear();
    tile_runs_.resize(count);
    tile_cells_.assign(count, {});
}

void LayerSplats::finish() {
    builders_->of_thread.clear();
    kernels_.build();
    for (const Row& row : rows_) {
        parts_.insert(parts_.end(), row.parts.begin(), row.parts.end());
        largest_radius_px_ = std::max(largest_radius_px_, row.largest_radius_px);
        colours_.include(row.colours);
    }
    std::sort(parts_.begin(), parts_.end());
    parts_.erase(std::unique(parts_.begin(), parts_.end()), parts_.end());
    if (keep_ != Keep::all) return;
    kernels_.forget_keys();
    begin_tile_rows();
    finish_strip();
}

std::vector<std::pair<int, int>> LayerSplats::begin_strip(const RasterWindow& part, int block_px) {
    if (keep_ != Keep::strip) strip_rows_ = {source_, picture_, block_px};
    keep_ = Keep::strip;
    strip_ = part;
    begin_tile_rows();
    rows_.clear();
    rows_.resize(static_cast<std::size_t>(source_.height()));
    for (int y = source_.y_begin; y < source_.y_end; ++y) {
        UnsortedRow row;
        std::map<LayerPart, std::uint32_t> number;
        for (const auto& far : strip_rows_.far(y)) {
            if (!meet(reach_of(far.item.splat), part)) continue;
            const auto [found, is_new] =
                number.try_emplace(far.item.part, static_cast<std::uint32_t>(row.parts.size()));
            if (is_new) row.parts.push_back(far.item.part);
            row.part.push_back(found->second);
            row.splats.push_back(far.item.splat);
        }
        rows_[static_cast<std::size_t>(y - source_.y_begin)] = sorted(row);
    }
    return strip_rows_.to_be_read(part.y_begin, part.y_end);
}

void LayerSplats::finish_strip() {
    join_rows(tile_runs_.size());
    sort_cells();
}

double LayerSplats::largest_coc_px() const {
    return 2 * largest_radius_px_;
}

}  // namespace postlens
