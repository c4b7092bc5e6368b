#include "focus/scatter/splat_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>

#include "core/threads.h"

namespace postlens {
namespace {

constexpr std::uint32_t no_level = ~std::uint32_t{0};

/// Returns the smallest number of adjacent samples with the same disc radius for which blurring them together
/// is faster than one by one. The time to blur them together grows with the disc's area, but the time for a
/// single sample only with its circumference.
int shortest_run(double radius_px) {
    return 6 + static_cast<int>(std::min(radius_px, 4096.0) / 16);
}

}  // namespace

/// Finds the blur kernels of samples, and stores the samples with their kernels as splats. It processes one
/// row of samples at a time. Row y contains the samples at the upper edges of the pixels in row y, and those
/// inside these pixels. Each thread needs its own builder.
class SplatTables::RowBuilder {
  public:
    explicit RowBuilder(SplatTables& tables)
        : t_(tables), round_(tables.responses_.model().is_round()), cache_(tables.kernels_) {}

    void build(const RecordBand& band, const PointSamples& samples, const PlainCorners& plain,
               std::size_t row, int y);
    void build(std::span<const PixelLight> lights, int y);

  private:
    void begin_row(int y);
    void store_row();
    void add_plain(const PlainCorners& plain, std::size_t row);
    void add_sample(const PointSample& s, std::span<const Record> nodes);
    void add_light(const PixelLight& light);
    void add_splats(const PointSample& s, const NodeResponse& response, const std::array<float, 3>& rgb,
                    float weight);
    void add_splat(std::int32_t column, const KernelKey& key, const std::array<float, 3>& rgb, float weight) {
        splats_.push_back({column, cache_.number_of(key), rgb[0], rgb[1], rgb[2], weight});
    }
    void split_runs();

    SplatTables& t_;
    bool round_;  ///< all responses are discs and ellipses
    KernelNumberCache cache_;
    std::vector<std::uint32_t>
        level_;  ///< per column, the level of the corner stored in raster_, or no_level if there is none
    std::vector<Splat> splats_;
    std::vector<SplatRun> runs_;
    std::array<float*, 3> raster_{};
    glm::dvec2 place_px_{0};  ///< position of the sample, from the image's centre
    int y_ = 0;
    double largest_radius_px_ = 0;
    bool negative_ = false;
};

void SplatTables::RowBuilder::add_splats(const PointSample& s, const NodeResponse& response,
                                         const std::array<float, 3>& rgb, float weight) {
    const Phases phases = t_.responses_.phases(s, response);
    for (std::size_t i = 0; i < phases.count; ++i) {
        const Phase& p = phases.items[i];
        KernelKey key = response.key;
        key.phase_x = p.x;
        key.phase_y = p.y;
        add_splat(static_cast<std::int32_t>(std::floor(s.x)), key,
                  {rgb[0] * p.weight, rgb[1] * p.weight, rgb[2] * p.weight}, weight * p.weight);
    }
}

void SplatTables::RowBuilder::add_sample(const PointSample& s, std::span<const Record> nodes) {
    place_px_ = from_middle_px(t_.picture_, s.x, s.y);
    const bool whole_corner = is_whole_corner(s);
    const double depth = inverse_depth_per_m(nodes[0]);
    const NodeResponses& responses = t_.responses_;
    const NodeResponse primary = responses.to_depth(depth, place_px_);
    // Finds the largest circle of confusion (CoC), which is reported to the user. Only directly visible
    // surfaces at a finite depth count. Surfaces in a mirror or behind glass do not count, because near a
    // caustic their CoC could be arbitrarily large.
    if (depth > 0) largest_radius_px_ = std::max(largest_radius_px_, primary.exact_radius_px);
    t_.border_.note(t_.source_, s, y_, primary.farthest_px);
    std::array<float, 3> rgb{nodes[0].r, nodes[0].g, nodes[0].b};
    for (const Record& node : nodes.subspan(1)) {
        if (is_dark(node)) continue;
        negative_ |= node.r < 0 || node.g < 0 || node.b < 0;
        const NodeResponse response = responses.of(node, primary, place_px_);
        if (response.key == primary.key) {
            rgb = {rgb[0] + node.r, rgb[1] + node.g, rgb[2] + node.b};
            continue;
        }
        const float share = responses.passing(response, place_px_);
        const std::array<float, 3> shared{share * node.r, share * node.g, share * node.b};
        if (whole_corner) {
            add_splat(static_cast<std::int32_t>(s.x), response.key, shared, 0);
        } else {
            add_splats(s, response, shared, 0);
        }
    }
    const float share = responses.passing(primary, place_px_);
    for (float& channel : rgb) channel *= share;
    negative_ |= rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0;

    if (whole_corner && primary.key.is_disc && round_) {
        const auto column = static_cast<std::size_t>(static_cast<int>(s.x) - t_.source_.x_begin);
        level_[column] = primary.key.level;
        for (std::size_t c = 0; c < 3; ++c) raster_[c][column] = rgb[c];
        return;
    }
    if (!(s.total_weight() > 0)) return;
    add_splats(s, primary, rgb, share);
}

// Adds the plain samples of a row: samples without reflections, at corners of undivided pixels (see
// PlainCorners). The result is the same as that of add_sample, but this is faster, because the blur kernels
// for all depths of the row are found at once.
void SplatTables::RowBuilder::add_plain(const PlainCorners& plain, std::size_t row) {
    const std::size_t width = level_.size(), at = row * width;
    const std::span inverse = std::span(plain.inverse_depth).subspan(at, width);
    t_.responses_.levels().levels_of(inverse, level_.data());
    for (std::size_t i = 0; i < width; ++i) level_[i] = inverse[i] < 0 ? no_level : level_[i];
    std::copy_n(plain.r.data() + at, width, raster_[0]);
    std::copy_n(plain.g.data() + at, width, raster_[1]);
    std::copy_n(plain.b.data() + at, width, raster_[2]);
    const PlainCorners::Row& facts = plain.rows[row];
    negative_ |= facts.negative;
    if (facts.least_inverse > facts.greatest_inverse) return;
    // The signed CoC radius is linear in the inverse depth. So its absolute value is largest for the smallest
    // or the largest inverse depth.
    for (const double end : {facts.least_inverse, facts.greatest_inverse}) {
        const double radius_px = std::abs(t_.responses_.geometry().coc_diameter_px(end) / 2);
        largest_radius_px_ = std::max(largest_radius_px_, radius_px);
    }
}

void SplatTables::RowBuilder::add_light(const PixelLight& light) {
    if (light.hidden) return;
    const PointSample s = middle_of_pixel(light.x, y_);
    place_px_ = from_middle_px(t_.picture_, s.x, s.y);
    const NodeResponses& responses = t_.responses_;
    const NodeResponse response = responses.to_depth(light.spread_depth, place_px_);
    if (light.inverse_depth > 0) largest_radius_px_ = std::max(largest_radius_px_, response.exact_radius_px);
    t_.border_.note_pixel(t_.source_, light.x, y_, response.farthest_px);
    const float share = responses.passing(response, place_px_);
    const std::array<float, 3> rgb{share * light.rgb[0], share * light.rgb[1], share * light.rgb[2]};
    negative_ |= rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0;
    add_splats(s, response, rgb, share * light.weight);
}

void SplatTables::RowBuilder::split_runs() {
    const std::size_t sparse = splats_.size();
    for (std::size_t begin = 0; begin < level_.size();) {
        const std::uint32_t level = level_[begin];
        std::size_t end = begin + 1;
        while (end < level_.size() && level_[end] == level) ++end;
        const auto at = static_cast<std::int32_t>(begin) + t_.source_.x_begin;
        if (level != no_level) {
            t_.kernels_.use_disc(level);
            if (static_cast<int>(end - begin) >= shortest_run(t_.kernels_.disc_radius_px(level))) {
                runs_.push_back({at, static_cast<std::int32_t>(end) + t_.source_.x_begin, level});
            } else {
                for (std::size_t i = begin; i < end; ++i) {
                    splats_.push_back({at + static_cast<std::int32_t>(i - begin), level, raster_[0][i],
                                       raster_[1][i], raster_[2][i], 1.0F});
                }
            }
        }
        begin = end;
    }
    std::inplace_merge(splats_.begin(), splats_.begin() + static_cast<std::ptrdiff_t>(sparse), splats_.end(),
                       [](const Splat& a, const Splat& b) { return a.x < b.x; });
}

void SplatTables::RowBuilder::begin_row(int y) {
    const auto row = static_cast<std::size_t>(y - t_.source_.y_begin);
    const auto width = static_cast<std::size_t>(t_.source_.width());
    y_ = y;
    largest_radius_px_ = 0;
    negative_ = false;
    level_.assign(width, no_level);
    splats_.clear();
    runs_.clear();
    for (std::size_t c = 0; c < 3; ++c) raster_[c] = t_.raster_[c].get() + row * width;
}

void SplatTables::RowBuilder::store_row() {
    const auto row = static_cast<std::size_t>(y_ - t_.source_.y_begin);
    SplatRow& out = t_.rows_[row];
    out.runs.assign(runs_.begin(), runs_.end());
    if (t_.keep_ == Keep::all) out.splats.assign(splats_.begin(), splats_.end());
    if (t_.keep_ == Keep::strip) {
        t_.strip_rows_.begin_row(y_);
        std::erase_if(splats_, [&](const Splat& s) {
            const Reach reach = t_.reach_of(s);
            t_.strip_rows_.add(y_, s, y_ + reach.dy_begin, y_ + reach.dy_end);
            return !t_.reaches_strip(s, reach, y_);
        });
        out.splats.assign(splats_.begin(), splats_.end());
    }
    t_.row_largest_radius_px_[row] = largest_radius_px_;
    t_.row_negative_[row] = negative_ ? 1 : 0;
}

void SplatTables::RowBuilder::build(const RecordBand& band, const PointSamples& samples,
                                    const PlainCorners& plain, std::size_t row, int y) {
    begin_row(y);
    const auto add = [&](std::uint32_t i) {
        const PointSample& s = samples.samples[i];
        add_sample(s, std::span(band.records).subspan(s.first_record, s.record_count));
    };
    if (round_ && t_.responses_.levels().around_focus()) {
        add_plain(plain, row);
        for (std::uint32_t k = plain.other_begin[row]; k < plain.other_begin[row + 1]; ++k)
            add(plain.others[k]);
    } else {
        const std::size_t width = level_.size();
        for (std::uint32_t i = samples.offsets[row * width]; i < samples.offsets[(row + 1) * width]; ++i)
            add(i);
    }
    split_runs();
    store_row();
}

void SplatTables::RowBuilder::build(std::span<const PixelLight> lights, int y) {
    begin_row(y);
    for (const PixelLight& light : lights) add_light(light);
    store_row();
}

struct SplatTables::Builders {
    explicit Builders(SplatTables& tables) : of_thread([&tables] { return RowBuilder(tables); }) {}
    tbb::enumerable_thread_specific<RowBuilder> of_thread;
};

SplatTables::~SplatTables() = default;

void SplatTables::add_pixels(int y, std::span<const PixelLight> lights) {
    builders_->of_thread.local().build(lights, y);
}

KernelReach kernel_reach(const RasterWindow& source, const RasterWindow& picture) {
    // Limits of the size of a blur kernel along x and y: the largest distance between a sample and a pixel of
    // the image, plus 1 px. A kernel's centre may lie up to 1 px from the pixel at which the kernel is added.
    return {std::max(source.x_end - picture.x_begin, picture.x_end - source.x_begin) + 1,
            std::max(source.y_end - picture.y_begin, picture.y_end - source.y_begin) + 1};
}

SplatTables::SplatTables(const RasterWindow& source, const RasterWindow& picture,
                         const FocusGeometry& geometry, const DepthLevels& levels, DepthModel model,
                         std::shared_ptr<const ResponseModel> response)
    : source_(source),
      picture_(picture),
      responses_(geometry, levels, model, response ? std::move(response) : std::make_shared<ResponseModel>()),
      kernels_(levels.radius_px(), kernel_reach(source, picture), responses_.model()),
      builders_(std::make_unique<Builders>(*this)),
      border_(source) {
    const auto width = static_cast<std::size_t>(source.width());
    const auto height = static_cast<std::size_t>(source.height());
    for (auto& plane : raster_) plane = std::make_unique_for_overwrite<float[]>(width * height);
    rows_.resize(height);
    row_largest_radius_px_.resize(height);
    row_negative_.resize(height);
}

void SplatTables::add_rows(const FrameRows& rows) {
    constexpr int step = FrameRows::rows_per_task;
    const RecordBand& band = *rows.band;
    const auto tasks = static_cast<std::size_t>((rows.y_end - rows.y_begin + step - 1) / step);
    parallel_for(tasks, [&](std::size_t task) {
        const int first = rows.y_begin + static_cast<int>(task) * step;
        const int last = std::min(first + step, rows.y_end);
        PointSamples found;
        PlainCorners found_plain;
        if (rows.samples.empty()) {
            find_point_samples(band, first, last, source_.y_begin, source_.y_end - 1, found);
            find_plain_corners(band, found, found_plain);
        }
        const PointSamples& samples = rows.samples.empty() ? found : rows.samples[task];
        const PlainCorners& plain = rows.samples.empty() ? found_plain : rows.plain[task];
        RowBuilder& builder = builders_->of_thread.local();
        for (int y = first; y < last; ++y)
            builder.build(band, samples, plain, static_cast<std::size_t>(y - first), y);
    });
    if (keep_ == Keep::strip) strip_rows_.settle();
}

std::size_t reach_class(const Reach& reach) {
    constexpr std::array<int, reach_classes - 1> limits_px{8, 16, 32, 64, 256};
    const int farthest = std::max({-reach.dy_begin, reach.dy_end, -reach.dx_begin, reach.dx_end});
    return static_cast<std::size_t>(std::lower_bound(limits_px.begin(), limits_px.end(), farthest) -
                                    limits_px.begin());
}

// Sorts the samples of a row by the size class of their blur kernels, then by column.
void SplatTables::sort_by_reach(SplatRow& row) const {
    const std::vector<Splat> unsorted = row.splats;
    std::vector<std::uint8_t> classes;
    classes.reserve(unsorted.size());
    row.class_reach = {};
    row.class_begin = {};
    for (const Splat& s : unsorted) {
        const Reach& reach = reach_of(s);
        classes.push_back(static_cast<std::uint8_t>(reach_class(reach)));
        row.class_reach[classes.back()].include(reach);
        ++row.class_begin[classes.back() + 1U];
    }
    std::partial_sum(row.class_begin.begin(), row.class_begin.end(), row.class_begin.begin());
    std::array<std::uint32_t, reach_classes + 1> to = row.class_begin;
    for (std::size_t i = 0; i < unsorted.size(); ++i) row.splats[to[classes[i]]++] = unsorted[i];
}

void SplatTables::sort_rows() {
    parallel_for(
        rows_.size(), [&](std::size_t i) { sort_by_reach(rows_[i]); }, 16);
    class_reach_ = {};
    for (const SplatRow& row : rows_) {
        for (std::size_t c = 0; c < reach_classes; ++c) class_reach_[c].include(row.class_reach[c]);
    }
}

void SplatTables::finish() {
    builders_->of_thread.clear();
    kernels_.build();
    if (keep_ == Keep::all) kernels_.forget_keys();
    for (SplatRow& row : rows_) {
        for (const SplatRun& run : row.runs) {
            row.run_dy_begin = std::min(row.run_dy_begin, kernels_[run.kernel].y_begin);
            row.run_dy_end = std::max(row.run_dy_end, kernels_[run.kernel].y_end());
        }
        run_dy_begin_ = std::min(run_dy_begin_, row.run_dy_begin);
        run_dy_end_ = std::max(run_dy_end_, row.run_dy_end);
    }
    sort_rows();
    any_negative_ = std::find(row_negative_.begin(), row_negative_.end(), 1) != row_negative_.end();
}

bool SplatTables::reaches_strip(const Splat& splat, const Reach& reach, int y) const {
    return y + reach.dy_end > strip_.y_begin && y + reach.dy_begin < strip_.y_end &&
           splat.x + reach.dx_end > strip_.x_begin && splat.x + reach.dx_begin < strip_.x_end;
}

std::vector<std::pair<int, int>> SplatTables::begin_strip(const RasterWindow& part, int block_px) {
    if (keep_ != Keep::strip) strip_rows_ = {source_, picture_, block_px};
    keep_ = Keep::strip;
    strip_ = part;
    for (int y = source_.y_begin; y < source_.y_end; ++y) {
        std::vector<Splat> splats;
        for (const auto& far : strip_rows_.far(y)) {
            if (reaches_strip(far.item, reach_of(far.item), y)) splats.push_back(far.item);
        }
        rows_[static_cast<std::size_t>(y - source_.y_begin)].splats = std::move(splats);
    }
    return strip_rows_.to_be_read(part.y_begin, part.y_end);
}

void SplatTables::finish_strip() {
    builders_->of_thread.clear();
    sort_rows();
}

double SplatTables::largest_coc_px() const {
    const auto largest = std::max_element(row_largest_radius_px_.begin(), row_largest_radius_px_.end());
    return largest != row_largest_radius_px_.end() ? 2 * *largest : 0;
}

}  // namespace postlens
