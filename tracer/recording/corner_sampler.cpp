#include "tracer/recording/corner_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/threads.h"
#include "records/record_check.h"

namespace postlens {
namespace {

// Position on the grid of all cell corners, in units of 2^-levels px from the window's upper left corner.
using Key = std::uint64_t;  // y << 32 | x

// The properties of a point sample that decide about subdivision, and where its records lie.
struct Sample {
    std::uint32_t x = 0, y = 0;  // grid units
    std::uint32_t chunk = 0, first = 0, count = 0;
    std::uint32_t visible = 0;  // number of records of layer 0, which come first
    std::uint32_t id = 0;       // of the primary node
    float z = 0;                // z' of the primary node, m
    float r = 0, g = 0, b = 0;
};

struct Cell {
    std::uint32_t x, y;                   // grid units, upper left
    std::uint32_t size;                   // grid units; a cell of size 1 cannot be split
    std::array<std::uint32_t, 4> corner;  // sample indices: upper left, upper right, lower left, lower right
};

// Rows of pixels that are traced together. 64 rows have enough tiles to occupy all threads, and need little
// memory at any raster width.
constexpr int band_rows = 64;
constexpr int tile = 32;
constexpr std::size_t batch_size = 256;

class BandSampler {
  public:
    BandSampler(const WhittedTracer& tracer, const SampledWindow& window, const SubdivisionSettings& settings,
                const SmallThings& things)
        : tracer_(tracer),
          things_(things),
          window_(window),
          settings_(settings),
          unit_(1U << settings.levels),
          columns_(window.x_end - window.x_begin + 1) {}

    RayCounts counts;

    void band(int y_begin, int y_end, RecordBand& out) {
        const bool first = y_begin == window_.y_begin, last = y_end == window_.y_end;
        start_band(y_begin, y_end, first);
        refine(y_begin, y_end);
        emit(y_begin, last ? y_end + 1 : y_end, out);
        if (!last) carry(y_end);
    }

  private:
    [[nodiscard]] static Key key(std::uint32_t x, std::uint32_t y) { return (static_cast<Key>(y) << 32) | x; }
    [[nodiscard]] std::uint32_t grid_y(int y) const {
        return static_cast<std::uint32_t>(y - window_.y_begin) * unit_;
    }
    [[nodiscard]] std::uint32_t to_pixels(std::uint32_t grid) const { return grid >> settings_.levels; }
    [[nodiscard]] glm::dvec2 position(Key k) const {
        return {window_.x_begin + static_cast<double>(static_cast<std::uint32_t>(k)) / unit_,
                window_.y_begin + static_cast<double>(k >> 32) / unit_};
    }
    [[nodiscard]] std::size_t corner_index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }
    [[nodiscard]] std::uint32_t corner(int column, int row) const {
        return corners_[corner_index(column, row)];
    }

    // Traces batches of points and appends their samples in order. `fill(i, keys)` writes the `sizes[i]`
    // points of batch i. `traced(index, sample)` is called for every sample. `around(key)` returns samples
    // near a point that were traced before it. All three functions are called from any thread.
    template <typename Fill, typename Traced>
    void trace(const std::vector<std::uint32_t>& sizes, const Fill& fill, const Traced& traced,
               const std::function<SamplesAround(Key)>& around = {}) {
        const std::size_t first_chunk = used_chunks_, batches = sizes.size();
        used_chunks_ += batches;
        if (chunks_.size() < used_chunks_) chunks_.resize(used_chunks_);
        std::vector<std::uint32_t> first_sample(batches);
        auto count = static_cast<std::uint32_t>(samples_.size());
        for (std::size_t i = 0; i < batches; ++i) {
            first_sample[i] = count;
            count += sizes[i];
        }
        samples_.resize(count);
        std::vector<RayCounts> spent(batches);
        parallel_for(batches, [&](std::size_t i) {
            thread_local std::vector<Key> keys;
            thread_local std::vector<glm::dvec2> positions;
            keys.clear();
            fill(i, keys);
            positions.clear();
            for (const Key k : keys) positions.push_back(position(k));
            TracedSamples& chunk = chunks_[first_chunk + i];
            const auto near = [&](std::size_t at) { return around(keys[at]); };
            tracer_.trace(positions, chunk, spent[i],
                          around ? std::function<SamplesAround(std::size_t)>(near) : nullptr);
            for (std::uint32_t k = 0; k < sizes[i]; ++k) {
                Sample& s = samples_[first_sample[i] + k];
                s = summary(keys[k], chunk, static_cast<std::uint32_t>(first_chunk + i), k);
                traced(first_sample[i] + k, s);
            }
        });
        for (const RayCounts& c : spent) counts += c;
    }

    // A record's radiance without its noisy part. The contrast of this part decides which cells split,
    // because noise would split every cell.
    [[nodiscard]] static glm::vec3 steady(const TracedSamples& chunk, std::size_t record) {
        const Record& r = chunk.records[record];
        const glm::vec3 all(r.r, r.g, r.b);
        return chunk.noisy.empty() ? all : all - chunk.noisy[record];
    }

    [[nodiscard]] static Sample summary(Key k, const TracedSamples& chunk, std::uint32_t chunk_index,
                                        std::uint32_t at) {
        const std::uint32_t first = chunk.offsets[at], end = chunk.offsets[at + 1];
        Sample s{static_cast<std::uint32_t>(k),
                 static_cast<std::uint32_t>(k >> 32),
                 chunk_index,
                 first,
                 end - first,
                 0,
                 chunk.records[first].id,
                 chunk.records[first].z,
                 0,
                 0,
                 0};
        for (std::uint32_t n = first; n < end && chunk.records[n].layer == 0; ++n) {
            ++s.visible;
            const glm::vec3 c = steady(chunk, n);
            s.r += c.r;
            s.g += c.g;
            s.b += c.b;
        }
        return s;
    }

    // Traces all pixel corners of the band. The first row of corners was traced with the band above, if there
    // is one.
    void start_band(int y_begin, int y_end, bool first) {
        const int rows = y_end - y_begin + 1, first_row = first ? 0 : 1;
        corners_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns_), 0);
        carried_over_.clear();
        for (std::uint32_t i = 0; i < samples_.size(); ++i) place(i, y_begin);

        struct Tile {
            int x, y, x_end, y_end;
        };
        std::vector<Tile> tiles;
        std::vector<std::uint32_t> sizes;
        for (int y = first_row; y < rows; y += tile) {
            for (int x = 0; x < columns_; x += tile) {
                tiles.push_back({x, y, std::min(x + tile, columns_), std::min(y + tile, rows)});
                sizes.push_back(
                    static_cast<std::uint32_t>((tiles.back().x_end - x) * (tiles.back().y_end - y)));
            }
        }
        const auto fill = [&](std::size_t i, std::vector<Key>& keys) {
            const Tile& t = tiles[i];
            // A packet of 16 rays is a block of 4 x 4 corners.
            for (int by = t.y; by < t.y_end; by += 4) {
                for (int bx = t.x; bx < t.x_end; bx += 4) {
                    for (int y = by; y < std::min(by + 4, t.y_end); ++y) {
                        for (int x = bx; x < std::min(bx + 4, t.x_end); ++x) {
                            keys.push_back(key(static_cast<std::uint32_t>(x) * unit_, grid_y(y_begin + y)));
                        }
                    }
                }
            }
        };
        trace(sizes, fill, [&](std::uint32_t index, const Sample& s) {
            const std::size_t row = to_pixels(s.y - grid_y(y_begin));
            corners_[row * static_cast<std::size_t>(columns_) + to_pixels(s.x)] = index;
        });
    }

    // Indexes a sample of the band above: pixel corners by row and column, other samples by key.
    void place(std::uint32_t i, int y_begin) {
        const Sample& s = samples_[i];
        if (s.x % unit_ == 0 && s.y % unit_ == 0) {
            const std::size_t row = to_pixels(s.y - grid_y(y_begin));
            corners_[row * static_cast<std::size_t>(columns_) + to_pixels(s.x)] = i;
        } else {
            carried_over_.emplace(key(s.x, s.y), i);
        }
    }

    // The properties of one layer of a sample that decide about subdivision. The layer's nodes are the
    // records [first, first + count) of `chunk`, sorted by path.
    struct Seen {
        std::uint32_t id = 0;
        std::array<float, 3> rgb{};
        const TracedSamples* chunk = nullptr;
        std::uint32_t first = 0, count = 0;
    };

    [[nodiscard]] bool differ(const Cell& c, const Seen* s, int count) const {
        for (int i = 1; i < count; ++i) {
            if (s[i].id != s[0].id)
                return c.size > unit_ >> std::min(settings_.edge_levels, settings_.levels);
        }
        if (c.size <= unit_ >> std::min(settings_.colour_levels, settings_.levels)) return false;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            float lo = s[0].rgb[channel], hi = lo;
            for (int i = 1; i < count; ++i) {
                lo = std::min(lo, s[i].rgb[channel]);
                hi = std::max(hi, s[i].rgb[channel]);
            }
            if (has_contrast(lo, hi)) return true;
        }
        return pattern_between(s, count);
    }

    // Contrast as in [mitchell1987]. The term 0.05 keeps small differences of dark colours from splitting.
    [[nodiscard]] bool has_contrast(double lo, double hi) const {
        return (hi - lo) / (hi + lo + 0.05) > settings_.threshold;
    }

    // True if a cell whose corners have similar colours still contains an edge: the texture between the
    // corners has contrast, or different lights are shadowed at them.
    [[nodiscard]] bool pattern_between(const Seen* s, int count) const {
        if (s[0].chunk->sources.empty()) return false;
        for (std::uint32_t n = 0; n < s[0].count; ++n) {
            const auto node = nodes_like(s, count, n);
            if (node && (shadows_differ(s, *node, count) || texture_differs(s, *node, count))) return true;
        }
        return false;
    }

    // Lists the nodes at the corners of a leaf (an undivided cell) between which the texture has contrast.
    // Only leaves of the smallest size that contrast can produce are examined.
    void mark_leaf(const Cell& c, std::size_t row) {
        if (!tracer_.has_textures() ||
            c.size > std::max(1U, unit_ >> std::min(settings_.colour_levels, settings_.levels)))
            return;
        std::array<Seen, 4> seen;
        std::array<std::uint32_t, 4> at{};
        for (std::size_t i = 0; i < 4; ++i) seen[i] = take_layer(samples_[c.corner[i]], at[i]);
        mark_textures(seen, row);
        while (std::all_of(at.begin(), at.end(), [&, i = std::size_t{0}](std::uint32_t a) mutable {
            return a < samples_[c.corner[i++]].count;
        })) {
            for (std::size_t i = 0; i < 4; ++i) seen[i] = take_layer(samples_[c.corner[i]], at[i]);
            mark_textures(seen, row);
        }
    }

    void mark_textures(const std::array<Seen, 4>& s, std::size_t row) {
        for (std::uint32_t n = 0; n < s[0].count; ++n) {
            const auto node = nodes_like(s.data(), 4, n);
            if (!node || !texture_differs(s.data(), *node, 4)) continue;
            for (std::size_t i = 0; i < 4; ++i)
                marks_[row].emplace_back(static_cast<std::uint32_t>(s[i].chunk - chunks_.data()), (*node)[i]);
        }
    }

    // The n-th node of the first corner, and at each other corner the node with the same path and id. Empty
    // if a corner has no such node.
    [[nodiscard]] static std::optional<std::array<std::uint32_t, 4>> nodes_like(const Seen* s, int count,
                                                                                std::uint32_t n) {
        std::array<std::uint32_t, 4> node{s[0].first + n};
        for (int i = 1; i < count; ++i) {
            const auto found = node_like(s[0].chunk->records[node[0]], s[i]);
            if (!found) return std::nullopt;
            node[static_cast<std::size_t>(i)] = *found;
        }
        return node;
    }

    // The node with the path and the id of `wanted`.
    [[nodiscard]] static std::optional<std::uint32_t> node_like(const Record& wanted, const Seen& in) {
        for (std::uint32_t n = in.first; n < in.first + in.count; ++n) {
            const Record& r = in.chunk->records[n];
            if (r.path == wanted.path) return r.id == wanted.id ? std::optional(n) : std::nullopt;
        }
        return std::nullopt;
    }

    [[nodiscard]] static bool shadows_differ(const Seen* s, const std::array<std::uint32_t, 4>& node,
                                             int count) {
        for (int i = 1; i < count; ++i) {
            if (s[i].chunk->sources[node[static_cast<std::size_t>(i)]].shadows !=
                s[0].chunk->sources[node[0]].shadows)
                return true;
        }
        return false;
    }

    // Whether the lit texture has contrast between the texture positions of the corners.
    [[nodiscard]] bool texture_differs(const Seen* s, const std::array<std::uint32_t, 4>& node,
                                       int count) const {
        const Texture* texture = s[0].chunk->sources[node[0]].texture;
        if (texture == nullptr) return false;
        glm::vec3 low = s[0].chunk->sources[node[0]].place, high = low;
        for (int i = 1; i < count; ++i) {
            const ColourSource& source = s[i].chunk->sources[node[static_cast<std::size_t>(i)]];
            if (source.texture != texture) return false;
            low = glm::min(low, source.place);
            high = glm::max(high, source.place);
        }
        const ColourRange range = texture->range(low, high);
        if (range.low == range.high) return false;
        for (int channel = 0; channel < 3; ++channel) {
            // The radiance is modelled as plus + times * texel, where texel is the texture's colour.
            double times = 0, plus = HUGE_VAL;
            std::array<double, 4> texel{};
            for (int i = 0; i < count; ++i) {
                const auto k = static_cast<std::size_t>(i);
                texel[k] = texture->colour_at(s[i].chunk->sources[node[k]].place)[channel];
                if (texel[k] > 1e-6)
                    times = std::max(times,
                                     static_cast<double>(steady(*s[i].chunk, node[k])[channel]) / texel[k]);
            }
            for (int i = 0; i < count; ++i) {
                const auto k = static_cast<std::size_t>(i);
                plus = std::min(plus, static_cast<double>(s[i].rgb[static_cast<std::size_t>(channel)]) -
                                          times * texel[k]);
            }
            plus = std::max(plus, 0.0);
            if (has_contrast(plus + times * range.low[channel], plus + times * range.high[channel]))
                return true;
        }
        return false;
    }

    // Reads the layer that begins at `at`, an index into the sample's records, and advances `at` to its end.
    [[nodiscard]] Seen take_layer(const Sample& s, std::uint32_t& at) const {
        const TracedSamples& chunk = chunks_[s.chunk];
        const Record* r = chunk.records.data() + s.first;
        const std::uint32_t layer = r[at].layer;
        Seen out{r[at].id, {}, &chunk, s.first + at, 0};
        for (; at < s.count && r[at].layer == layer; ++at) {
            const glm::vec3 c = steady(chunk, s.first + at);
            out.rgb[0] += c.r;
            out.rgb[1] += c.g;
            out.rgb[2] += c.b;
            ++out.count;
        }
        return out;
    }

    [[nodiscard]] bool splits(const Cell& c) const {
        std::array<Seen, 4> seen;
        bool hidden = false;
        for (std::size_t i = 0; i < 4; ++i) {
            const Sample& s = samples_[c.corner[i]];
            seen[i] = {s.id, {s.r, s.g, s.b}, &chunks_[s.chunk], s.first, s.visible};
            hidden = hidden || s.count > s.visible;
        }
        return differ(c, seen.data(), 4) || (hidden && hidden_layers_differ(c)) ||
               (!things_.empty() && small_things_ask(c, hidden));
    }

    // A cell's corners can all miss a narrow object, so a cell that may contain such an object is split.
    // Objects behind the farthest visible node are ignored, unless a corner of the cell has hidden layers.
    [[nodiscard]] bool small_things_ask(const Cell& c, bool hidden) const {
        float farthest = 0;
        bool edge = false;
        for (const std::uint32_t corner : c.corner) {
            const Sample& s = samples_[corner];
            farthest = std::max(farthest, s.z);
            edge = edge || s.id != samples_[c.corner[0]].id;
        }
        const glm::dvec2 at = position(key(c.x, c.y));
        const double size = static_cast<double>(c.size) / unit_;
        const SmallThings::Wanted wanted =
            things_.wanted(at.x, at.y, size,
                           hidden ? std::numeric_limits<double>::infinity() : static_cast<double>(farthest));
        return size > wanted.find_px || (edge && size > wanted.outline_px);
    }

    // Hidden layers split cells by the same criteria as visible ones. Corners that lack a layer do not take
    // part in its comparison. A hidden layer that begins after a bounce has no primary node, so a layer is
    // compared only with layers whose first node has the same path.
    [[nodiscard]] bool hidden_layers_differ(const Cell& c) const {
        std::array<std::uint32_t, 4> at{};
        for (std::size_t i = 0; i < 4; ++i) at[i] = samples_[c.corner[i]].visible;
        for (;;) {
            constexpr std::uint32_t none = 0xFFFFFFFFU;
            std::uint32_t path = none;
            for (std::size_t i = 0; i < 4; ++i) path = std::min(path, next_path(c.corner[i], at[i], none));
            if (path == none) return false;
            std::array<Seen, 4> seen;
            int count = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                if (next_path(c.corner[i], at[i], none) != path) continue;
                seen[static_cast<std::size_t>(count++)] = take_layer(samples_[c.corner[i]], at[i]);
            }
            if (differ(c, seen.data(), count)) return true;
        }
    }

    // The path of the first node of the layer that begins at index `at` of the sample's records; `none` after
    // the last layer.
    [[nodiscard]] std::uint32_t next_path(std::uint32_t sample, std::uint32_t at, std::uint32_t none) const {
        const Sample& s = samples_[sample];
        return at < s.count ? chunks_[s.chunk].records[s.first + at].path.bits() : none;
    }

    using CellRows = std::vector<std::vector<Cell>>;  // one list of cells per row of pixels

    void refine(int y_begin, int y_end) {
        marks_.assign(static_cast<std::size_t>(y_end - y_begin), {});
        refine_cells(y_begin, y_end);
        for (const auto& row : marks_) {
            for (const auto& [chunk, record] : row)
                chunks_[chunk].records[record].mark |= RecordMark::fine_texture;
        }
    }

    void refine_cells(int y_begin, int y_end) {
        CellRows cells = split_pixels(y_begin, y_end), next(cells.size());
        while (std::any_of(cells.begin(), cells.end(), [](const auto& row) { return !row.empty(); })) {
            trace_missing(cells, y_begin, y_end);
            parallel_for(cells.size(), [&](std::size_t row) {
                next[row].clear();
                for (const Cell& c : cells[row]) split(c, row, next[row]);
            });
            cells.swap(next);
        }
    }

    [[nodiscard]] CellRows split_pixels(int y_begin, int y_end) {
        CellRows cells(static_cast<std::size_t>(y_end - y_begin));
        parallel_for(cells.size(), [&](std::size_t r) {
            const int row = static_cast<int>(r);
            for (int x = 0; x + 1 < columns_; ++x) {
                const Cell c{
                    static_cast<std::uint32_t>(x) * unit_,
                    grid_y(y_begin + row),
                    unit_,
                    {corner(x, row), corner(x + 1, row), corner(x, row + 1), corner(x + 1, row + 1)}};
                if (settings_.levels > 0 && splits(c)) {
                    cells[r].push_back(c);
                } else {
                    mark_leaf(c, r);
                }
            }
        });
        return cells;
    }

    // Traces the centre and the midpoints of the sides of every cell. Neighbouring cells share midpoints,
    // which are traced once; those on the band's upper edge may have been traced with the band above.
    void trace_missing(const CellRows& cells, int y_begin, int y_end) {
        // One list of points per row of pixels. A row includes its upper edge; the last list is the band's
        // lower edge.
        std::vector<std::vector<Key>> inside(cells.size() + 1), below(cells.size() + 1);
        parallel_for(cells.size(), [&](std::size_t row) {
            const std::uint32_t end = grid_y(y_begin + static_cast<int>(row) + 1);
            for (const Cell& c : cells[row]) {
                const std::uint32_t h = c.size / 2;
                for (const auto& [dx, dy] : {std::pair{h, 0U}, {0U, h}, {h, h}, {c.size, h}, {h, c.size}}) {
                    const Key k = key(c.x + dx, c.y + dy);
                    if (row == 0 && carried_over_.contains(k)) continue;
                    (c.y + dy < end ? inside[row] : below[row + 1]).push_back(k);
                }
            }
        });
        parallel_for(inside.size(), [&](std::size_t row) {
            std::vector<Key>& keys = inside[row];
            keys.insert(keys.end(), below[row].begin(), below[row].end());
            std::sort(keys.begin(), keys.end());
            keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        });
        wanted_.clear();
        wanted_rows_.assign(1, 0);
        for (const std::vector<Key>& keys : inside) {
            wanted_.insert(wanted_.end(), keys.begin(), keys.end());
            wanted_rows_.push_back(wanted_.size());
        }
        std::vector<std::uint32_t> sizes;
        for (std::size_t i = 0; i < wanted_.size(); i += batch_size) {
            sizes.push_back(static_cast<std::uint32_t>(std::min(batch_size, wanted_.size() - i)));
        }
        const auto fill = [&](std::size_t i, std::vector<Key>& keys) {
            const auto first = wanted_.begin() + static_cast<std::ptrdiff_t>(i * batch_size);
            keys.assign(first, first + sizes[i]);
        };
        first_wanted_ = static_cast<std::uint32_t>(samples_.size());
        trace(
            sizes, fill, [](std::uint32_t, const Sample&) {},
            [&](Key k) { return corners_around(k, y_begin, y_end); });
    }

    // The sample at a centre or midpoint of a cell in this row of pixels.
    [[nodiscard]] std::uint32_t sample_at(Key k, std::size_t row) const {
        for (const std::size_t r : {row, row + 1}) {
            const auto first = wanted_.begin() + static_cast<std::ptrdiff_t>(wanted_rows_[r]),
                       last = wanted_.begin() + static_cast<std::ptrdiff_t>(wanted_rows_[r + 1]);
            const auto found = std::lower_bound(first, last, k);
            if (found != last && *found == k)
                return first_wanted_ + static_cast<std::uint32_t>(found - wanted_.begin());
        }
        return carried_over_.at(k);
    }

    // The samples at the four corners of a pixel that contains the point, inside or on its edge.
    [[nodiscard]] SamplesAround corners_around(Key k, int y_begin, int y_end) const {
        const int column = std::min(static_cast<int>(to_pixels(static_cast<std::uint32_t>(k))), columns_ - 2),
                  row = std::min(
                      static_cast<int>(to_pixels(static_cast<std::uint32_t>(k >> 32) - grid_y(y_begin))),
                      y_end - y_begin - 1);
        SamplesAround out;
        for (int i = 0; i < 4; ++i) {
            const Sample& s = samples_[corner(column + i % 2, row + i / 2)];
            out[static_cast<std::size_t>(i)] = {chunks_[s.chunk].records.data() + s.first, s.count};
        }
        return out;
    }

    void split(const Cell& c, std::size_t row, std::vector<Cell>& next) {
        const std::uint32_t h = c.size / 2;
        const auto at = [&](std::uint32_t dx, std::uint32_t dy) {
            return sample_at(key(c.x + dx, c.y + dy), row);
        };
        const std::uint32_t top = at(h, 0), left = at(0, h), centre = at(h, h), right = at(c.size, h),
                            bottom = at(h, c.size);
        const std::array<Cell, 4> quarters{Cell{c.x, c.y, h, {c.corner[0], top, left, centre}},
                                           Cell{c.x + h, c.y, h, {top, c.corner[1], centre, right}},
                                           Cell{c.x, c.y + h, h, {left, centre, c.corner[2], bottom}},
                                           Cell{c.x + h, c.y + h, h, {centre, right, bottom, c.corner[3]}}};
        for (const Cell& q : quarters) {
            if (h > 1 && splits(q)) {
                next.push_back(q);
            } else {
                mark_leaf(q, row);
            }
        }
    }

    // Writes the records of pixel rows [y_begin, y_end), pixel by pixel.
    void emit(int y_begin, int y_end, RecordBand& out) {
        out.x_begin = window_.x_begin;
        out.x_end = window_.x_end + 1;
        out.y_begin = y_begin;
        out.y_end = y_end;
        const std::uint32_t end = grid_y(y_end);
        const auto pixel_of = [&](const Sample& s) {
            return static_cast<std::size_t>(to_pixels(s.y - grid_y(y_begin))) *
                       static_cast<std::size_t>(columns_) +
                   to_pixels(s.x);
        };
        const std::size_t pixels =
            static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(columns_);
        // A counting sort orders the samples by pixel. Within a pixel they are then sorted by (y, x), which
        // is the canonical order of a sample file.
        std::vector<std::uint32_t>& first = first_;
        first.assign(pixels + 1, 0);
        out.offsets.assign(pixels + 1, 0);
        for (const Sample& s : samples_) {
            if (s.y >= end) continue;
            ++first[pixel_of(s) + 1];
            out.offsets[pixel_of(s) + 1] += s.count;
        }
        for (std::size_t i = 0; i < pixels; ++i) {
            first[i + 1] += first[i];
            out.offsets[i + 1] += out.offsets[i];
        }
        std::vector<std::uint32_t>&order = order_, &next = next_;
        order.resize(first.back());
        next.assign(first.begin(), first.end() - 1);
        for (std::uint32_t i = 0; i < samples_.size(); ++i) {
            if (samples_[i].y < end) order[next[pixel_of(samples_[i])]++] = i;
        }
        out.records.resize(out.offsets.back());
        parallel_for(
            pixels,
            [&](std::size_t p) {
                const auto a = order.begin() + first[p], b = order.begin() + first[p + 1];
                if (b - a > 1) {
                    std::sort(a, b, [&](std::uint32_t i, std::uint32_t k) {
                        return key(samples_[i].x, samples_[i].y) < key(samples_[k].x, samples_[k].y);
                    });
                }
                Record* to = out.records.data() + out.offsets[p];
                for (auto i = a; i != b; ++i) {
                    const Sample& s = samples_[*i];
                    to = std::copy_n(chunks_[s.chunk].records.data() + s.first, s.visible, to);
                }
                Record* const hidden = to;
                for (auto i = a; i != b; ++i) {
                    const Sample& s = samples_[*i];
                    to = std::copy_n(chunks_[s.chunk].records.data() + s.first + s.visible,
                                     s.count - s.visible, to);
                }
                std::sort(hidden, to, canonical_before);
            },
            4096);
    }

    // Keeps the samples on the band's lower edge, which the next band shares: pixel corners and midpoints of
    // cells.
    void carry(int y_end) {
        const std::uint32_t edge = grid_y(y_end);
        carried_.records.clear();
        carried_.noisy.clear();
        carried_.sources.clear();
        std::size_t kept = 0;
        for (Sample s : samples_) {
            if (s.y != edge) continue;
            const auto& from = chunks_[s.chunk].records;
            const auto& noisy = chunks_[s.chunk].noisy;
            const auto at = static_cast<std::uint32_t>(carried_.records.size());
            carried_.records.insert(carried_.records.end(), from.begin() + s.first,
                                    from.begin() + s.first + s.count);
            if (!noisy.empty()) {
                carried_.noisy.insert(carried_.noisy.end(), noisy.begin() + s.first,
                                      noisy.begin() + s.first + s.count);
            }
            const auto& sources = chunks_[s.chunk].sources;
            if (!sources.empty()) {
                carried_.sources.insert(carried_.sources.end(), sources.begin() + s.first,
                                        sources.begin() + s.first + s.count);
            }
            s.chunk = 0;
            s.first = at;
            samples_[kept++] = s;
        }
        samples_.resize(kept);
        // Chunks are reused by the next band: freeing and allocating their memory again took longer than the
        // tracing itself.
        std::swap(chunks_[0], carried_);
        used_chunks_ = 1;
    }

    const WhittedTracer& tracer_;
    const SmallThings& things_;
    SampledWindow window_;
    SubdivisionSettings settings_;
    std::uint32_t unit_;
    int columns_;
    std::vector<TracedSamples> chunks_;  ///< the first `used_chunks_` are in use
    std::size_t used_chunks_ = 0;
    TracedSamples carried_;
    std::vector<Sample> samples_;
    std::vector<std::uint32_t> corners_;
    std::unordered_map<Key, std::uint32_t>
        carried_over_;  ///< samples of the band above, except pixel corners
    // Points that the last call of trace_missing traced, sorted within each row of pixels.
    std::vector<Key> wanted_;
    std::vector<std::size_t> wanted_rows_;  // per row, the index of its first point in wanted_
    std::uint32_t first_wanted_ = 0;        // the sample of wanted_[0]
    /// Per row of pixels: (chunk, record) of the records that get the mark for fine texture.
    std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> marks_;
    std::vector<std::uint32_t> first_, order_, next_;  // buffers of emit, reused to save allocations
};

}  // namespace

RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things) {
    BandSampler sampler(tracer, window, settings, things);
    RecordBand band;
    for (int y = window.y_begin; y < window.y_end; y += band_rows) {
        sampler.band(y, std::min(y + band_rows, window.y_end), band);
        take(band);
    }
    return sampler.counts;
}

}  // namespace postlens
