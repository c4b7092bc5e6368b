#include "tracer/corner_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/threads.h"

namespace postlens {
namespace {

// Positions on the dyadic grid: px * 2^levels, offset so that the window starts at 0.
using Key = std::uint64_t;  // y << 32 | x

// What of a point sample decides about subdivision, and where its records lie.
struct Sample {
    std::uint32_t x, y;  // grid units
    std::uint32_t chunk, first, count;
    std::uint32_t id;
    float r, g, b;
};

struct Cell {
    std::uint32_t x, y;     // grid units, upper left
    std::uint32_t size;     // grid units; 1 cannot be split
    std::array<std::uint32_t, 4> corner;  // samples: upper left, upper right, lower left, lower right
};

// Rows of pixels traced together: enough tiles for any machine, little enough memory for any raster.
constexpr int band_rows = 64;
constexpr int tile = 16;
constexpr std::size_t batch_size = 256;

class BandSampler {
  public:
    BandSampler(const WhittedTracer& tracer, const SampledWindow& window, const SubdivisionSettings& settings)
        : tracer_(tracer), window_(window), settings_(settings), unit_(1U << settings.levels),
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
    [[nodiscard]] Key key(std::uint32_t x, std::uint32_t y) const { return (static_cast<Key>(y) << 32) | x; }
    [[nodiscard]] std::uint32_t grid_y(int y) const { return static_cast<std::uint32_t>(y - window_.y_begin) * unit_; }
    [[nodiscard]] glm::dvec2 position(std::uint32_t x, std::uint32_t y) const {
        return {window_.x_begin + static_cast<double>(x) / unit_, window_.y_begin + static_cast<double>(y) / unit_};
    }
    [[nodiscard]] std::uint32_t corner(int column, int row) const {
        return corners_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)];
    }

    // Traces batches of grid points; appends them to samples_ in the order given.
    void trace(const std::vector<std::vector<Key>>& batches) {
        const std::size_t first_chunk = chunks_.size();
        chunks_.resize(first_chunk + batches.size());
        std::vector<RayCounts> spent(batches.size());
        parallel_for(batches.size(), [&](std::size_t i) {
            std::vector<glm::dvec2> positions;
            positions.reserve(batches[i].size());
            for (const Key k : batches[i]) {
                positions.push_back(position(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(k >> 32)));
            }
            tracer_.trace(positions, chunks_[first_chunk + i], spent[i]);
        });
        for (std::size_t i = 0; i < batches.size(); ++i) {
            counts += spent[i];
            const TracedSamples& t = chunks_[first_chunk + i];
            for (std::size_t k = 0; k < batches[i].size(); ++k) {
                Sample s{static_cast<std::uint32_t>(batches[i][k]), static_cast<std::uint32_t>(batches[i][k] >> 32),
                         static_cast<std::uint32_t>(first_chunk + i), t.offsets[k], t.offsets[k + 1] - t.offsets[k], 0, 0, 0, 0};
                s.id = t.records[s.first].id;
                for (std::uint32_t n = s.first; n < s.first + s.count; ++n) {
                    s.r += t.records[n].r;
                    s.g += t.records[n].g;
                    s.b += t.records[n].b;
                }
                samples_.push_back(s);
            }
        }
    }

    // All corners of the band; the first row was traced with the band above unless there is none.
    void start_band(int y_begin, int y_end, bool first) {
        const int rows = y_end - y_begin + 1, first_row = first ? 0 : 1;
        corners_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns_), 0);
        found_.clear();
        if (first) {
            samples_.clear();
            chunks_.clear();
        }
        for (std::uint32_t i = 0; i < samples_.size(); ++i) place(i, y_begin);  // carried over

        std::vector<std::vector<Key>> batches;
        for (int ty = first_row; ty < rows; ty += tile) {
            for (int tx = 0; tx < columns_; tx += tile) {
                std::vector<Key> batch;
                // Packets of 16 rays are blocks of 4 x 4 corners.
                for (int by = ty; by < std::min(ty + tile, rows); by += 4) {
                    for (int bx = tx; bx < std::min(tx + tile, columns_); bx += 4) {
                        for (int y = by; y < std::min(by + 4, rows); ++y) {
                            for (int x = bx; x < std::min(bx + 4, columns_); ++x) {
                                batch.push_back(key(static_cast<std::uint32_t>(x) * unit_, grid_y(y_begin + y)));
                            }
                        }
                    }
                }
                batches.push_back(std::move(batch));
            }
        }
        const auto before = static_cast<std::uint32_t>(samples_.size());
        trace(batches);
        for (auto i = before; i < samples_.size(); ++i) place(i, y_begin);
    }

    // Makes a sample findable: corners by row and column, others by key.
    void place(std::uint32_t i, int y_begin) {
        const Sample& s = samples_[i];
        if (s.x % unit_ == 0 && s.y % unit_ == 0) {
            const std::size_t row = (s.y - grid_y(y_begin)) / unit_;
            corners_[row * static_cast<std::size_t>(columns_) + s.x / unit_] = i;
        } else {
            found_.emplace(key(s.x, s.y), i);
        }
    }

    [[nodiscard]] bool splits(const Cell& c) const {
        const std::array<const Sample*, 4> s{&samples_[c.corner[0]], &samples_[c.corner[1]], &samples_[c.corner[2]],
                                             &samples_[c.corner[3]]};
        if (s[1]->id != s[0]->id || s[2]->id != s[0]->id || s[3]->id != s[0]->id) return true;
        const auto contrast = [&](float Sample::*channel) {
            const auto [lo, hi] = std::minmax({s[0]->*channel, s[1]->*channel, s[2]->*channel, s[3]->*channel});
            // 0.05 keeps dark noise from splitting; contrast as in [mitchell1987].
            return static_cast<double>(hi - lo) / (static_cast<double>(hi + lo) + 0.05);
        };
        return contrast(&Sample::r) > settings_.threshold || contrast(&Sample::g) > settings_.threshold ||
               contrast(&Sample::b) > settings_.threshold;
    }

    void refine(int y_begin, int y_end) {
        if (settings_.levels == 0) return;
        std::vector<Cell> cells = split_pixels(y_begin, y_end);
        while (!cells.empty()) {
            trace_missing(cells);
            std::vector<Cell> next;
            for (const Cell& c : cells) split(c, next);
            cells.swap(next);
        }
    }

    [[nodiscard]] std::vector<Cell> split_pixels(int y_begin, int y_end) const {
        std::vector<std::vector<Cell>> by_row(static_cast<std::size_t>(y_end - y_begin));
        parallel_for(by_row.size(), [&](std::size_t r) {
            const int row = static_cast<int>(r);
            for (int x = 0; x + 1 < columns_; ++x) {
                const Cell c{static_cast<std::uint32_t>(x) * unit_, grid_y(y_begin + row), unit_,
                             {corner(x, row), corner(x + 1, row), corner(x, row + 1), corner(x + 1, row + 1)}};
                if (splits(c)) by_row[r].push_back(c);
            }
        });
        std::vector<Cell> cells;
        for (const auto& row : by_row) cells.insert(cells.end(), row.begin(), row.end());
        return cells;
    }

    // The centre and the middles of the sides of every cell, unless a neighbour asked for them before.
    void trace_missing(const std::vector<Cell>& cells) {
        std::vector<Key> wanted;
        wanted.reserve(cells.size() * 5);
        for (const Cell& c : cells) {
            const std::uint32_t h = c.size / 2;
            for (const auto& [dx, dy] : {std::pair{h, 0U}, {0U, h}, {h, h}, {c.size, h}, {h, c.size}}) {
                const Key k = key(c.x + dx, c.y + dy);
                if (!found_.contains(k)) wanted.push_back(k);
            }
        }
        std::sort(wanted.begin(), wanted.end());
        wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
        std::vector<std::vector<Key>> batches;
        for (std::size_t i = 0; i < wanted.size(); i += batch_size) {
            const auto end = std::min(i + batch_size, wanted.size());
            batches.emplace_back(wanted.begin() + static_cast<std::ptrdiff_t>(i), wanted.begin() + static_cast<std::ptrdiff_t>(end));
        }
        auto i = static_cast<std::uint32_t>(samples_.size());
        trace(batches);
        for (; i < samples_.size(); ++i) found_.emplace(key(samples_[i].x, samples_[i].y), i);
    }

    void split(const Cell& c, std::vector<Cell>& next) const {
        const std::uint32_t h = c.size / 2;
        if (h == 1) return;  // the quarters are leaves, whatever they hold
        const auto at = [&](std::uint32_t dx, std::uint32_t dy) { return found_.at(key(c.x + dx, c.y + dy)); };
        const std::uint32_t top = at(h, 0), left = at(0, h), centre = at(h, h), right = at(c.size, h), bottom = at(h, c.size);
        const std::array<Cell, 4> quarters{Cell{c.x, c.y, h, {c.corner[0], top, left, centre}},
                                           Cell{c.x + h, c.y, h, {top, c.corner[1], centre, right}},
                                           Cell{c.x, c.y + h, h, {left, centre, c.corner[2], bottom}},
                                           Cell{c.x + h, c.y + h, h, {centre, right, bottom, c.corner[3]}}};
        for (const Cell& q : quarters) {
            if (splits(q)) next.push_back(q);
        }
    }

    // The records of pixel rows [y_begin, y_end), pixel by pixel.
    void emit(int y_begin, int y_end, RecordBand& out) {
        out.x_begin = window_.x_begin;
        out.x_end = window_.x_end + 1;
        out.y_begin = y_begin;
        out.y_end = y_end;
        const std::uint32_t end = grid_y(y_end);
        const auto pixel_of = [&](const Sample& s) {
            return static_cast<std::size_t>((s.y - grid_y(y_begin)) / unit_) * static_cast<std::size_t>(columns_) + s.x / unit_;
        };
        const std::size_t pixels = static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(columns_);
        // Samples sorted by pixel with a counting sort, then by (y, x) within each: the canonical order.
        std::vector<std::uint32_t> first(pixels + 1, 0);
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
        std::vector<std::uint32_t> order(first.back()), next(first.begin(), first.end() - 1);
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
                    to = std::copy_n(chunks_[s.chunk].records.data() + s.first, s.count, to);
                }
            },
            4096);
    }

    // Keeps the samples on the lower edge: the next band's corners, and what its neighbours above traced there.
    void carry(int y_end) {
        const std::uint32_t edge = grid_y(y_end);
        TracedSamples kept;
        std::vector<Sample> samples;
        for (Sample s : samples_) {
            if (s.y != edge) continue;
            const auto& from = chunks_[s.chunk].records;
            const auto at = static_cast<std::uint32_t>(kept.records.size());
            kept.records.insert(kept.records.end(), from.begin() + s.first, from.begin() + s.first + s.count);
            s.chunk = 0;
            s.first = at;
            samples.push_back(s);
        }
        samples_ = std::move(samples);
        chunks_.clear();
        chunks_.push_back(std::move(kept));
    }

    const WhittedTracer& tracer_;
    SampledWindow window_;
    SubdivisionSettings settings_;
    std::uint32_t unit_;
    int columns_;
    std::vector<TracedSamples> chunks_;
    std::vector<Sample> samples_;
    std::vector<std::uint32_t> corners_;
    std::unordered_map<Key, std::uint32_t> found_;
};

}  // namespace

RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window, const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take) {
    BandSampler sampler(tracer, window, settings);
    RecordBand band;
    for (int y = window.y_begin; y < window.y_end; y += band_rows) {
        sampler.band(y, std::min(y + band_rows, window.y_end), band);
        take(band);
    }
    return sampler.counts;
}

}  // namespace postlens
