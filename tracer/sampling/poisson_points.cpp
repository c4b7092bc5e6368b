#include "tracer/sampling/poisson_points.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "core/multiversion.h"
#include "tracer/sampling/permutation.h"

namespace postlens {
namespace {

/// Returns the squared distance between two points on the torus [0, 1)^2, in units of 2^-64. It is at most
/// 2^63. The coordinates are in units of 2^-32.
std::uint64_t squared_distance(std::uint32_t au, std::uint32_t av, std::uint32_t bu, std::uint32_t bv) {
    const auto du = static_cast<std::int64_t>(static_cast<std::int32_t>(au - bu));
    const auto dv = static_cast<std::int64_t>(static_cast<std::int32_t>(av - bv));
    return static_cast<std::uint64_t>(du * du) + static_cast<std::uint64_t>(dv * dv);
}

/// Grid that finds the points near a position. Its cells are so small that each contains at most one point.
class DartGrid {
  public:
    explicit DartGrid(double distance)
        : squared_(static_cast<std::uint64_t>(distance * distance * 0x1p64)),
          cells_(static_cast<int>(std::ceil(std::sqrt(2.0) / distance))),
          point_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), -1) {}

    [[nodiscard]] bool has_room(const PoissonPattern& p, std::uint32_t u, std::uint32_t v) const {
        // Searches the neighbouring grid cells for a point that is closer to (u, v) than `distance`. A cell
        // is at least distance / 2 wide, so such a point can be at most two cells away along each axis.
        for (int dy = -2; dy <= 2; ++dy) {
            for (int dx = -2; dx <= 2; ++dx) {
                const int k = point_[cell(column(u) + dx, column(v) + dy)];
                const auto i = static_cast<std::size_t>(k);
                if (k >= 0 && squared_distance(u, v, p.u[i], p.v[i]) < squared_) return false;
            }
        }
        return true;
    }
    void put(int index, std::uint32_t u, std::uint32_t v) { point_[cell(column(u), column(v))] = index; }

  private:
    [[nodiscard]] int column(std::uint32_t x) const {
        return static_cast<int>((static_cast<std::uint64_t>(x) * static_cast<std::uint64_t>(cells_)) >> 32);
    }
    [[nodiscard]] std::size_t cell(int x, int y) const {
        const int wrapped_x = (x + 2 * cells_) % cells_, wrapped_y = (y + 2 * cells_) % cells_;
        return static_cast<std::size_t>(wrapped_y) * static_cast<std::size_t>(cells_) +
               static_cast<std::size_t>(wrapped_x);
    }
    std::uint64_t squared_;
    int cells_;
    std::vector<int> point_;
};

std::optional<PoissonPattern> throw_darts(int n, std::uint64_t key) {
    // Adds random points until there are n of them. A point that is too close to an earlier point is
    // discarded. Gives up after `limit` tries. This limit is high, because the last point alone needs 100
    // tries on average.
    const auto limit = static_cast<std::uint32_t>(1000 + 200 * n);
    PoissonPattern p;
    DartGrid grid(poisson_distance_share * densest_distance(n));
    for (std::uint32_t dart = 0; dart < limit; ++dart) {
        const std::uint32_t u = random_word(key, 2 * dart), v = random_word(key, 2 * dart + 1);
        if (!grid.has_room(p, u, v)) continue;
        grid.put(static_cast<int>(p.u.size()), u, v);
        p.u.push_back(u);
        p.v.push_back(v);
        if (p.u.size() == static_cast<std::size_t>(n)) return p;
    }
    return std::nullopt;
}

/// Consecutive samples inside a block.
struct PatternTask {
    const std::uint32_t *u, *v;  ///< the points of the block; v is null in one dimension
    std::uint32_t size, first;  ///< number of points of the block; index of the first sample within the block
    std::uint32_t shift_u, shift_v;
    std::uint64_t key;
    bool permuted;
};

template <int lanes>
[[gnu::always_inline]] inline void pattern_points(const PatternTask& t, float* u, float* v) {
    alignas(64) std::uint32_t index[lanes];
    for (int i = 0; i < lanes; ++i) {
        const std::uint32_t k = t.first + static_cast<std::uint32_t>(i);
        index[i] = k < t.size ? k : t.size - 1;
    }
    if (t.permuted) Permutation(t.size, t.key).permute<lanes>(index);
    for (int i = 0; i < lanes; ++i) u[i] = unit_float(t.u[index[i]] + t.shift_u);
    if (t.v == nullptr) return;
    for (int i = 0; i < lanes; ++i) v[i] = unit_float(t.v[index[i]] + t.shift_v);
}

POSTLENS_MULTIVERSION void pattern_points_16(const PatternTask& t, float* u, float* v) {
    pattern_points<sample_lanes>(t, u, v);
}

/// Writes one random point (u, v) for each of `count` samples of a pixel, where `count` is 1 to 16. All these
/// points come from one precomputed pattern, in which points have a minimum distance from each other.
void fill_run(const PatternTask& t, int count, float* u, float* v) {
    if (count == 1) return pattern_points<1>(t, u, v);
    if (count == sample_lanes) return pattern_points_16(t, u, v);
    alignas(64) float all_u[sample_lanes], all_v[sample_lanes];
    pattern_points_16(t, all_u, all_v);
    std::copy_n(all_u, count, u);
    if (t.v != nullptr) std::copy_n(all_v, count, v);
}

}  // namespace

double densest_distance(int n) {
    return std::sqrt(2 / (std::sqrt(3.0) * n));
}

PoissonPattern poisson_pattern(int n, std::uint64_t seed) {
    assert(n >= 1 && n <= PoissonPoints::max_block);
    if (n == 1) return {{0}, {0}};
    for (std::uint64_t attempt = 0;; ++attempt)
        if (auto p = throw_darts(n, mix64(seed + attempt))) return *std::move(p);
}

std::vector<std::uint32_t> poisson_circle(int n, std::uint64_t seed) {
    std::vector<double> free(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < free.size(); ++i)
        free[i] = random_word(seed, static_cast<std::uint32_t>(i)) * 0x1p-32;
    std::sort(free.begin(), free.end());
    std::vector<std::uint32_t> u(free.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
        const double at =
            (static_cast<double>(i) * poisson_distance_share) / n + (1 - poisson_distance_share) * free[i];
        u[i] = static_cast<std::uint32_t>(at * 0x1p32);
    }
    return u;
}

PoissonPoints::PoissonPoints(std::uint32_t n, std::uint64_t seed)
    : n_(n), blocks_((n + max_block - 1) / max_block) {
    assert(n >= 1 && n <= 1U << 20);
    const std::uint32_t least = n / blocks_;
    for (std::uint32_t more = 0; more < 2; ++more) {
        if (more == 1 && n % blocks_ == 0) break;  // all blocks have the same size
        for (std::size_t k = 0; k < patterns; ++k) {
            const SetKey key{mix64(seed) + 2 * k + more};
            sizes_[more].plane[k] = poisson_pattern(static_cast<int>(least + more), key.stream(0));
            sizes_[more].circle[k] = poisson_circle(static_cast<int>(least + more), key.stream(1));
        }
    }
}

PoissonPoints::Block PoissonPoints::block_of(std::uint32_t sample) const {
    // If n_ samples do not divide evenly into blocks_ blocks, the first n_ % blocks_ blocks have one sample
    // more than the others.
    const std::uint32_t least = n_ / blocks_, large = n_ % blocks_, in_large = large * (least + 1);
    if (sample < in_large) {
        const std::uint32_t k = sample / (least + 1);
        return {k, k * (least + 1), least + 1};
    }
    const std::uint32_t k = (sample - in_large) / least;
    return {large + k, in_large + k * least, least};
}

const PoissonPoints::Patterns& PoissonPoints::patterns_of(const Block& b) const {
    return sizes_[b.size - n_ / blocks_];
}

void PoissonPoints::fill_2d(SetKey key, bool permuted, int first, int count, float* u, float* v) const {
    for (int done = 0; done < count;) {
        const auto sample = static_cast<std::uint32_t>(first + done);
        const Block b = block_of(sample);
        const int run = std::min(count - done, static_cast<int>(b.begin + b.size - sample));
        const std::uint64_t shift = key.stream(3 * b.index), choice = key.stream(3 * b.index + 1);
        const PoissonPattern& p = patterns_of(b).plane[choice % patterns];
        fill_run({p.u.data(), p.v.data(), b.size, sample - b.begin, low_word(shift), high_word(shift),
                  key.stream(3 * b.index + 2), permuted},
                 run, u + done, v + done);
        done += run;
    }
}

void PoissonPoints::fill_1d(SetKey key, bool permuted, int first, int count, float* u) const {
    for (int done = 0; done < count;) {
        const auto sample = static_cast<std::uint32_t>(first + done);
        const Block b = block_of(sample);
        const int run = std::min(count - done, static_cast<int>(b.begin + b.size - sample));
        const std::uint64_t shift = key.stream(3 * b.index), choice = key.stream(3 * b.index + 1);
        const std::vector<std::uint32_t>& p = patterns_of(b).circle[choice % patterns];
        fill_run({p.data(), nullptr, b.size, sample - b.begin, low_word(shift), 0,
                  key.stream(3 * b.index + 2), permuted},
                 run, u + done, nullptr);
        done += run;
    }
}

}  // namespace postlens
