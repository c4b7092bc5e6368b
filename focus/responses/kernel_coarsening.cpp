// Rounds the shapes of blur kernels more coarsely if the kernels would exceed the memory limit.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "focus/responses/kernel.h"

namespace postlens {
namespace {

/// Rounds to a multiple of `unit`. Halves are rounded away from zero, so that n and -n are treated alike.
std::int32_t nearest_multiple(std::int32_t n, std::int32_t unit) {
    return (n < 0 ? -1 : 1) * ((std::abs(n) + unit / 2) / unit) * unit;
}

}  // namespace

void KernelKey::round_to(std::int32_t unit) {
    // Largest absolute value of the four integers below, which describe the blur of a kernel.
    // KernelKey::packed stores each of them in 17 bits, including the sign. A larger integer would overflow,
    // and different kernels could then get the same key.
    constexpr std::int32_t most = (1 << 16) - 1;
    for (std::int32_t* n : {&half_height, &half_chord, &top_displacement, &map_yy})
        *n = std::clamp(nearest_multiple(*n, unit), -most, most);
}

void KernelKey::round_map(int bits) {
    round_to(std::int32_t{1} << std::max(0, extent_bits() - bits));
}

int KernelKey::extent_bits() const {
    return static_cast<int>(std::bit_width(static_cast<std::uint32_t>(std::max(
        {std::abs(half_height), std::abs(half_chord), std::abs(top_displacement), std::abs(map_yy)}))));
}

void KernelKey::coarsen(int times) {
    if (times == 0) return;
    if (is_map) {
        round_map(std::max(1, map_bits - times));
        if (cell_log2 != 0) {
            cell_x >>= times;
            cell_y >>= times;
            cell_log2 += times;
        }
        return;
    }
    const int bits = std::max(1, std::min(ellipse_bits, extent_bits()) - times);
    const std::int32_t unit = std::int32_t{1} << std::max(0, extent_bits() - bits);
    if (unit == 1) return;
    round_to(unit);
    const std::int32_t step = std::min(phase_steps, 2 * unit);
    phase_x = nearest_multiple(phase_x, step);
    phase_y = nearest_multiple(phase_y, step);
}

// Saves memory if the blur kernels would need more than `memory_limit_bytes`. Each kernel is identified by a
// key, the rounded size and position of a blur ellipse. This function rounds the keys more coarsely, so that
// more samples share a kernel.
void KernelTable::coarsen_ellipses(std::size_t memory_limit_bytes) {
    constexpr std::size_t steps = KernelKey::most_coarsenings + 1;
    struct Octave {
        std::vector<std::uint32_t> numbers;
        std::array<std::size_t, steps> bytes{};  ///< memory, per number of coarsenings
        std::size_t times = 0;
    };
    std::array<Octave, std::numeric_limits<std::uint32_t>::digits + 1> octaves;
    std::size_t total = 0;
    for (auto number = static_cast<std::uint32_t>(levels()); number < keys_.size(); ++number) {
        if (keys_[number].is_disc) continue;
        Octave& octave = octaves[static_cast<std::size_t>(keys_[number].extent_bits())];
        octave.numbers.push_back(number);
        const std::size_t bytes = bytes_of(keys_[number]);
        octave.bytes[0] += bytes;
        total += bytes;
    }
    if (total <= memory_limit_bytes) return;
    parallel_for(octaves.size(), [&](std::size_t i) {
        // Keys that become equal by rounding share one kernel, that of the first key. Their order depends on
        // the timing of the threads that added them. Therefore, the keys are sorted, so that the first key is
        // always the same.
        std::vector<std::pair<KernelKey::Packed, std::uint32_t>> left, kept;
        left.reserve(octaves[i].numbers.size());
        for (const std::uint32_t number : octaves[i].numbers)
            left.emplace_back(keys_[number].packed(), number);
        std::sort(left.begin(), left.end());
        for (std::size_t times = 1; times < steps; ++times) {
            std::unordered_set<KernelKey::Packed, KernelKey::PackedHash> seen;
            kept.clear();
            for (const auto& of : left) {
                KernelKey key = keys_[of.second];
                key.coarsen(static_cast<int>(times));
                if (!seen.insert(key.packed()).second) continue;
                kept.push_back(of);
                octaves[i].bytes[times] += bytes_of(key);
            }
            left.swap(kept);
        }
    });
    const auto error = [](std::size_t octave, std::size_t times) {
        const int bits = std::min(static_cast<int>(octave), KernelKey::ellipse_bits);
        return std::ldexp(1.0, static_cast<int>(times) - bits);
    };
    while (total > memory_limit_bytes) {
        Octave* best = nullptr;
        std::size_t best_times = 0;
        double most = 0;
        for (std::size_t i = 0; i < octaves.size(); ++i) {
            Octave& o = octaves[i];
            for (std::size_t times = o.times + 1; times < steps; ++times) {
                if (o.bytes[times] >= o.bytes[o.times]) continue;
                const double gain =
                    static_cast<double>(o.bytes[o.times] - o.bytes[times]) /
                    (static_cast<double>(o.numbers.size()) * (error(i, times) - error(i, o.times)));
                if (gain <= most) continue;
                most = gain;
                best = &o;
                best_times = times;
            }
        }
        if (best == nullptr) break;
        total -= best->bytes[best->times] - best->bytes[best_times];
        best->times = best_times;
    }
    for (const Octave& octave : octaves) {
        for (const std::uint32_t number : octave.numbers)
            keys_[number].coarsen(static_cast<int>(octave.times));
    }
}

}  // namespace postlens
