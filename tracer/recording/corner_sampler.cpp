#include "tracer/recording/corner_sampler.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/floor_div.h"
#include "core/threads.h"
#include "tracer/recording/cell_split.h"
#include "tracer/recording/corner_grid.h"
#include "tracer/recording/corner_records.h"

namespace postlens {
namespace {

// Number of pixel rows in a band. The image is traced band by band, and only the records of one band are in
// memory at the same time. A band contains two rows of tiles, which are `tile` x `tile` px large and are
// traced in parallel. This is enough work for all threads.
constexpr int band_rows = 32;
constexpr int tile = 16;
constexpr std::size_t batch_size = 256;

// Returns the end of the group of pixel rows that contains row y. Rows are traced in groups, which begin at
// multiples of `rows`. So row y always belongs to the same group, even if the tracing begins at another row.
// Therefore, its records, which may depend on others of the group, are always the same.
int next_multiple(int y, int rows) {
    return (floor_div(y, rows) + 1) * rows;
}

class BandSampler {
  public:
    BandSampler(const WhittedTracer& tracer, const SampledWindow& window, const SubdivisionSettings& settings,
                const SmallThings& things)
        : tracer_(tracer),
          settings_(settings),
          grid_(window, settings.levels),
          cells_(tracer, things, settings_, grid_, samples_, chunks_) {}

    RayCounts counts;

    // Traces the rows of a band. Bands must be traced from top to bottom.
    void trace_band(int y_begin, int y_end) {
        const bool first = y_begin == grid_.window.y_begin;
        if (!first) carry(y_begin);
        start_band(y_begin, y_end, first);
        refine(y_begin, y_end);
        records_.sort(grid_, std::span(samples_).first(sample_count_), y_begin, end_of_records(y_end));
    }

    // Writes the records (surface hits) of the pixel rows y_begin to y_end - 1 to `out`. These rows must
    // belong to the band of pixel rows that was traced last.
    void emit(int y_begin, int y_end, RecordBand& out) {
        records_.emit(grid_, samples_, chunks_, y_begin, end_of_records(y_end), out);
    }

  private:
    // Returns up to which row (exclusive) the records are complete when the pixel rows before `y_end` have
    // been traced. A sample on the edge between two pixel rows belongs to the lower one. So n pixel rows
    // complete n rows of records. Only below the last pixel row of the window, the samples on its lower edge
    // form one more row.
    [[nodiscard]] int end_of_records(int y_end) const {
        return y_end == grid_.window.y_end ? y_end + 1 : y_end;
    }
    [[nodiscard]] std::size_t corner_index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.columns) +
               static_cast<std::size_t>(column);
    }
    [[nodiscard]] std::uint32_t corner(int column, int row) const {
        return corners_[corner_index(column, row)];
    }

    // Traces eye rays in batches, in parallel. Batch i consists of sizes[i] rays. `fill` sets the raster
    // positions of the rays of a batch. After tracing, `traced` is called with the result of each ray. All
    // functions must be thread-safe.
    template <typename Fill, typename Traced>
    void trace(const std::vector<std::uint32_t>& sizes, const Fill& fill, const Traced& traced,
               const std::function<SamplesAround(CornerKey)>& around = {}, bool for_comparison = false) {
        const std::size_t first_chunk = used_chunks_, batches = sizes.size();
        used_chunks_ += batches;
        if (chunks_.size() < used_chunks_) chunks_.resize(used_chunks_);
        std::vector<std::uint32_t> first_sample(batches);
        for (std::size_t i = 0; i < batches; ++i) {
            first_sample[i] = sample_count_;
            sample_count_ += sizes[i];
        }
        if (samples_.size() < sample_count_) samples_.resize(sample_count_);
        std::vector<RayCounts> spent(batches);
        parallel_for(batches, [&](std::size_t i) {
            thread_local std::vector<CornerKey> keys;
            thread_local std::vector<glm::dvec2> positions;
            keys.clear();
            fill(i, keys);
            positions.clear();
            for (const CornerKey k : keys) positions.push_back(grid_.position(k));
            TracedSamples& chunk = chunks_[first_chunk + i];
            const auto near = [&](std::size_t at) { return around(keys[at]); };
            if (for_comparison) {
                tracer_.trace_steady(positions, chunk, spent[i]);
            } else {
                tracer_.trace(positions, chunk, spent[i],
                              around ? std::function<SamplesAround(std::size_t)>(near) : nullptr);
            }
            for (std::uint32_t k = 0; k < sizes[i]; ++k) {
                CornerSample& s = samples_[first_sample[i] + k];
                s = summary(keys[k], chunk, static_cast<std::uint32_t>(first_chunk + i), k);
                traced(first_sample[i] + k, s);
            }
        });
        for (const RayCounts& c : spent) counts += c;
    }

    // Traces points and appends their samples in order.
    void trace(const std::vector<CornerKey>& points, const std::function<SamplesAround(CornerKey)>& around,
               bool for_comparison = false) {
        std::vector<std::uint32_t> sizes;
        for (std::size_t i = 0; i < points.size(); i += batch_size)
            sizes.push_back(static_cast<std::uint32_t>(std::min(batch_size, points.size() - i)));
        const auto fill = [&](std::size_t i, std::vector<CornerKey>& keys) {
            const auto first = points.begin() + static_cast<std::ptrdiff_t>(i * batch_size);
            keys.assign(first, first + sizes[i]);
        };
        trace(
            sizes, fill, [](std::uint32_t, const CornerSample&) {}, around, for_comparison);
    }

    [[nodiscard]] static CornerSample summary(CornerKey k, const TracedSamples& chunk,
                                              std::uint32_t chunk_index, std::uint32_t at) {
        const std::uint32_t first = chunk.offsets[at], end = chunk.offsets[at + 1];
        CornerSample s{static_cast<std::uint32_t>(k),
                       static_cast<std::uint32_t>(k >> 32),
                       chunk_index,
                       first,
                       end - first,
                       0,
                       chunk.records[first].id,
                       chunk.sources.empty() ? 0 : chunk.sources[first].part,
                       chunk.records[first].z,
                       0,
                       0,
                       0};
        for (std::uint32_t n = first; n < end && chunk.records[n].layer == 0; ++n) {
            ++s.visible;
            const glm::vec3 c = steady_radiance(chunk, n);
            s.r += c.r;
            s.g += c.g;
            s.b += c.b;
        }
        return s;
    }

    // Traces the pixel corners of a band of rows. Skips the uppermost corners if the band above has traced
    // them.
    void start_band(int y_begin, int y_end, bool first) {
        const int rows = y_end - y_begin + 1, first_row = first ? 0 : 1;
        corners_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(grid_.columns), 0);
        carried_over_.clear();
        for (std::uint32_t i = 0; i < sample_count_; ++i) place(i, y_begin);

        struct Tile {
            int x, y, x_end, y_end;
        };
        std::vector<Tile> tiles;
        std::vector<std::uint32_t> sizes;
        for (int y = first_row; y < rows; y += tile) {
            for (int x = 0; x < grid_.columns; x += tile) {
                tiles.push_back({x, y, std::min(x + tile, grid_.columns), std::min(y + tile, rows)});
                sizes.push_back(
                    static_cast<std::uint32_t>((tiles.back().x_end - x) * (tiles.back().y_end - y)));
            }
        }
        const auto fill = [&](std::size_t i, std::vector<CornerKey>& keys) {
            const Tile& t = tiles[i];
            // Each packet of 16 rays is a block of 4 x 4 pixel corners, so its rays are coherent.
            for (int by = t.y; by < t.y_end; by += 4) {
                for (int bx = t.x; bx < t.x_end; bx += 4) {
                    for (int y = by; y < std::min(by + 4, t.y_end); ++y) {
                        for (int x = bx; x < std::min(bx + 4, t.x_end); ++x) {
                            keys.push_back(CornerGrid::key(static_cast<std::uint32_t>(x) * grid_.unit,
                                                           grid_.row(y_begin + y)));
                        }
                    }
                }
            }
        };
        trace(sizes, fill, [&](std::uint32_t index, const CornerSample& s) {
            const std::size_t row = grid_.to_pixels(s.y - grid_.row(y_begin));
            corners_[row * static_cast<std::size_t>(grid_.columns) + grid_.to_pixels(s.x)] = index;
        });
    }

    // Makes sample number i available to the current band of pixel rows. The sample lies on the upper edge of
    // this band, and was traced with the band above. If it is a corner of a pixel, its index is stored in
    // `corners_`. Otherwise, it is stored in `carried_over_` under its raster position, so that it is not
    // traced again.
    void place(std::uint32_t i, int y_begin) {
        const CornerSample& s = samples_[i];
        if (s.x % grid_.unit == 0 && s.y % grid_.unit == 0) {
            const std::size_t row = grid_.to_pixels(s.y - grid_.row(y_begin));
            corners_[row * static_cast<std::size_t>(grid_.columns) + grid_.to_pixels(s.x)] = i;
        } else {
            carried_over_.emplace(CornerGrid::key(s.x, s.y), i);
        }
    }

    using CellRows = std::vector<std::vector<CornerCell>>;  // one list of cells for each row of pixels
    // A raster point whose sample is missing although a quadtree cell needs it to be divided into quarters.
    // An eye ray is then traced through this point, `key`. The index of the resulting sample is written to
    // `*sample`. This is an element of CornerCell::between, the cell's list of samples at the new corners.
    struct Missing {
        CornerKey key;
        std::uint32_t* sample;
    };

    void refine(int y_begin, int y_end) {
        CellRows cells = split_pixels(y_begin, y_end), next(cells.size());
        while (std::any_of(cells.begin(), cells.end(), [](const auto& row) { return !row.empty(); })) {
            trace_missing(cells, y_begin, y_end);
            parallel_for(cells.size(), [&](std::size_t row) {
                next[row].clear();
                for (const CornerCell& c : cells[row]) split(c, next[row]);
            });
            cells.swap(next);
        }
    }

    [[nodiscard]] CornerCell pixel(int x, int row, int y_begin) const {
        return {static_cast<std::uint32_t>(x) * grid_.unit,
                grid_.row(y_begin + row),
                grid_.unit,
                {corner(x, row), corner(x + 1, row), corner(x, row + 1), corner(x + 1, row + 1)},
                {}};
    }

    // Decides which pixels are divided. First, the samples at the corners of each pixel are compared. Beside
    // a divided pixel, an object may lie between the corners of a pixel and so be missed. Therefore, the
    // pixels on the left and on the right of a divided pixel get a sample at the centre, which is compared,
    // too.
    [[nodiscard]] CellRows split_pixels(int y_begin, int y_end) {
        CellRows cells(static_cast<std::size_t>(y_end - y_begin)), beside(cells.size());
        const int columns = grid_.columns - 1;
        std::vector<std::vector<bool>> decided(cells.size());
        parallel_for(cells.size(), [&](std::size_t r) {
            decided[r].resize(static_cast<std::size_t>(columns));
            for (int x = 0; settings_.levels > 0 && x < columns; ++x) {
                const CornerCell c = pixel(x, static_cast<int>(r), y_begin);
                if (!cells_.splits(c)) continue;
                cells[r].push_back(c);
                decided[r][static_cast<std::size_t>(x)] = true;
            }
        });
        std::vector<std::size_t> first_new(cells.size(), 0);
        do {
            parallel_for(cells.size(), [&](std::size_t r) {
                beside[r].clear();
                for (std::size_t& k = first_new[r]; k < cells[r].size(); ++k) {
                    const auto column = static_cast<int>(grid_.to_pixels(cells[r][k].x));
                    for (const int x : {column - 1, column + 1}) {
                        if (x < 0 || x >= columns || decided[r][static_cast<std::size_t>(x)]) continue;
                        decided[r][static_cast<std::size_t>(x)] = true;
                        beside[r].push_back(pixel(x, static_cast<int>(r), y_begin));
                    }
                }
            });
            compare_centres(beside, cells);
        } while (std::any_of(beside.begin(), beside.end(), [](const auto& row) { return !row.empty(); }));
        parallel_for(cells.size(), [&](std::size_t r) {
            for (int x = 0; x < columns; ++x) {
                if (!decided[r][static_cast<std::size_t>(x)])
                    cells_.mark_leaf(pixel(x, static_cast<int>(r), y_begin));
            }
        });
        return cells;
    }

    // Traces an eye ray through the centre of each of the `cells`, which are quadtree cells. If it sees a
    // different surface or colour than the rays through the cell's corners, the cell is added to `divided`.
    void compare_centres(const CellRows& cells, CellRows& divided) {
        std::vector<CornerKey> centres;
        std::vector<std::size_t> first_of_row;
        for (const auto& row : cells) {
            first_of_row.push_back(centres.size());
            for (const CornerCell& c : row)
                centres.push_back(CornerGrid::key(c.x + c.size / 2, c.y + c.size / 2));
        }
        const std::uint32_t samples = sample_count_;
        const std::size_t chunks = used_chunks_;
        trace(centres, {}, true);
        parallel_for(cells.size(), [&](std::size_t r) {
            for (std::size_t k = 0; k < cells[r].size(); ++k) {
                const CornerCell& c = cells[r][k];
                if (cells_.centre_differs(c, static_cast<std::uint32_t>(samples + first_of_row[r] + k)))
                    divided[r].push_back(c);
                else
                    cells_.mark_leaf(c);
            }
        });
        sample_count_ = samples;
        used_chunks_ = chunks;
    }

    // Prepares `cells`, quadtree cells that are to be divided into quarters. The quarters have five new
    // corners: the cell's centre and the midpoints of its sides. An eye ray is traced through each of these
    // points that has no sample yet. If several cells share a midpoint, it is traced only once.
    void trace_missing(CellRows& cells, int y_begin, int y_end) {
        // The raster points through which eye rays are to be traced, in lists for each pixel row. A point
        // belongs to the row that contains it or whose upper edge contains it. The rows are searched in
        // parallel, so each row fills only its own lists: inside[row] takes its points, and below[row + 1]
        // takes the points on its lower edge, which belong to the next row. Therefore, there is one list more
        // than there are rows.
        std::vector<std::vector<Missing>> inside(cells.size() + 1), below(cells.size() + 1);
        std::vector<std::size_t> first(cells.size() + 2, 0);  // per row, the index of its first point
        parallel_for(cells.size(), [&](std::size_t row) {
            const std::uint32_t end = grid_.row(y_begin + static_cast<int>(row) + 1);
            for (CornerCell& c : cells[row]) {
                const std::uint32_t h = c.size / 2;
                std::uint32_t* sample = c.between.data();
                for (const auto& [dx, dy] : {std::pair{h, 0U}, {0U, h}, {h, h}, {c.size, h}, {h, c.size}}) {
                    const CornerKey k = CornerGrid::key(c.x + dx, c.y + dy);
                    std::vector<Missing>& points = c.y + dy < end ? inside[row] : below[row + 1];
                    const auto carried = row == 0 ? carried_over_.find(k) : carried_over_.end();
                    if (carried == carried_over_.end()) {
                        points.push_back({k, sample});
                    } else {
                        *sample = carried->second;
                    }
                    ++sample;
                }
            }
        });
        parallel_for(inside.size(), [&](std::size_t row) {
            std::vector<Missing>& points = inside[row];
            points.insert(points.end(), below[row].begin(), below[row].end());
            std::sort(points.begin(), points.end(),
                      [](const Missing& a, const Missing& b) { return a.key < b.key; });
            for (std::size_t i = 0; i < points.size(); ++i)
                first[row + 1] += i == 0 || points[i].key != points[i - 1].key ? 1 : 0;
        });
        std::partial_sum(first.begin(), first.end(), first.begin());
        wanted_.resize(first.back());
        const std::uint32_t first_sample = sample_count_;
        parallel_for(inside.size(), [&](std::size_t row) {
            std::size_t next = first[row];
            for (const Missing& m : inside[row]) {
                if (next == first[row] || wanted_[next - 1] != m.key) wanted_[next++] = m.key;
                *m.sample = first_sample + static_cast<std::uint32_t>(next - 1);
            }
        });
        trace(wanted_, [&](CornerKey k) { return corners_around(k, y_begin, y_end); });
    }

    // Returns the samples at the four corners of the pixel that contains the raster point k, which is a
    // corner or a midpoint of a quadtree cell. If k lies on the lower edge of the current band of pixel rows,
    // the pixel above this edge is used, because the band below has not been traced yet.
    [[nodiscard]] SamplesAround corners_around(CornerKey k, int y_begin, int y_end) const {
        const int column = std::min(static_cast<int>(grid_.to_pixels(static_cast<std::uint32_t>(k))),
                                    grid_.columns - 2),
                  row = std::min(static_cast<int>(grid_.to_pixels(static_cast<std::uint32_t>(k >> 32) -
                                                                  grid_.row(y_begin))),
                                 y_end - y_begin - 1);
        SamplesAround out;
        for (int i = 0; i < 4; ++i) {
            const CornerSample& s = samples_[corner(column + i % 2, row + i / 2)];
            out[static_cast<std::size_t>(i)] = {chunks_[s.chunk].records.data() + s.first, s.count};
        }
        return out;
    }

    void split(const CornerCell& c, std::vector<CornerCell>& next) {
        const std::uint32_t h = c.size / 2;
        const auto [top, left, centre, right, bottom] = c.between;
        const std::array<CornerCell, 4> quarters{
            CornerCell{c.x, c.y, h, {c.corner[0], top, left, centre}, {}},
            CornerCell{c.x + h, c.y, h, {top, c.corner[1], centre, right}, {}},
            CornerCell{c.x, c.y + h, h, {left, centre, c.corner[2], bottom}, {}},
            CornerCell{c.x + h, c.y + h, h, {centre, right, bottom, c.corner[3]}, {}}};
        for (const CornerCell& q : quarters) {
            if (h > 1 && cells_.splits(q)) {
                next.push_back(q);
            } else {
                cells_.mark_leaf(q);
            }
        }
    }

    // Keeps the samples on the lower edge of the traced band, because the next band shares this edge.
    void carry(int y_begin) {
        const std::uint32_t edge = grid_.row(y_begin);
        carried_.records.clear();
        carried_.noisy.clear();
        carried_.sources.clear();
        carried_.arrivals.clear();
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < sample_count_; ++i) {
            CornerSample s = samples_[i];
            if (s.y != edge) continue;
            const TracedSamples& chunk = chunks_[s.chunk];
            const auto at = static_cast<std::uint32_t>(carried_.records.size());
            const auto keep = [&s](const auto& from, auto& to) {
                if (from.empty()) return;
                const auto first = from.begin() + s.first;
                to.insert(to.end(), first, first + s.count);
            };
            keep(chunk.records, carried_.records);
            keep(chunk.noisy, carried_.noisy);
            keep(chunk.sources, carried_.sources);
            keep(chunk.arrivals, carried_.arrivals);
            s.chunk = 0;
            s.first = at;
            samples_[kept++] = s;
        }
        sample_count_ = kept;
        // Ends a band of pixel rows. `chunks_` are buffers of records. The records on the band's lower edge,
        // `carried_`, are needed by the next band, and become its first buffer. The other buffers are kept
        // and overwritten, because releasing and allocating their memory for each band took longer than
        // tracing.
        std::swap(chunks_[0], carried_);
        used_chunks_ = 1;
    }

    const WhittedTracer& tracer_;
    SubdivisionSettings settings_;
    CornerGrid grid_;
    std::vector<TracedSamples> chunks_;  ///< the first `used_chunks_` are in use
    std::size_t used_chunks_ = 0;
    TracedSamples carried_;
    std::vector<CornerSample> samples_;  ///< the first `sample_count_` are in use
    std::uint32_t sample_count_ = 0;
    std::vector<std::uint32_t> corners_;
    std::unordered_map<CornerKey, std::uint32_t>
        carried_over_;               ///< samples of the band above that are not pixel corners
    std::vector<CornerKey> wanted_;  ///< points that trace_missing traces, sorted within each row of pixels
    CellSplit cells_;
    CornerRecords records_;
};

}  // namespace

RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things) {
    BandSampler sampler(tracer, window, settings, things);
    // Each band is passed on in parts, which need less memory.
    constexpr int part_rows = band_rows / 4;
    std::vector<int> rows{window.y_begin};  // where parts begin and end
    while (rows.back() < window.y_end)
        rows.push_back(std::min(next_multiple(rows.back(), part_rows), window.y_end));
    std::array<RecordBand, 4> parts;
    run_overlapped(
        rows.size() - 1, parts.size() - 1,
        [&](std::size_t i) {
            const int band_end = std::min(next_multiple(rows[i], band_rows), window.y_end);
            if (i == 0 || rows[i] % band_rows == 0) sampler.trace_band(rows[i], band_end);
            sampler.emit(rows[i], rows[i + 1], parts[i % parts.size()]);
        },
        [&](std::size_t i) { take(parts[i % parts.size()]); });
    return sampler.counts;
}

}  // namespace postlens
