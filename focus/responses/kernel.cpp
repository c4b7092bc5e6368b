#include "focus/responses/kernel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>

#include "core/memory.h"
#include "core/threads.h"
#include "focus/responses/response_model.h"

namespace postlens {
namespace {

/// The interior pixels of a kernel row all have the same value. If there are at least this many, the value is
/// stored once for all of them. If there are fewer, the value is stored for each pixel, which is as fast.
constexpr int shortest_inner_px = 6;

/// Radius, in px, of the disc that replaces a blur ellipse whose sizes are all 0. Such an ellipse would have
/// no area, so its light could not be distributed over pixels. The disc is so small that its kernel is that
/// of a point.
constexpr double smallest_ellipse_px = 1e-4;

std::int32_t steps(double px, double step_px) {
    constexpr double most = 1 << 20;  // valid sizes are smaller; overflows and NaN need a defined value
    const double exact = std::min(most, std::max(-most, px / step_px));
    return static_cast<std::int32_t>(exact + std::copysign(0.5, exact));
}

/// Builds a kernel from EllipseRows or OutlineRows.
template <typename Rows>
Kernel kernel_of_rows(const Rows& source, KernelReach reach) {
    Kernel out;
    out.inner = static_cast<float>(source.inner_share());
    out.y_begin = std::max(source.y_begin(), -reach.y);
    const int y_end = std::min(source.y_end(), reach.y);
    CoverageSpan span;
    for (int y = out.y_begin; y < y_end; ++y) {
        source.row(y, span);
        KernelRow row{.x_begin = std::max(span.x_begin, -reach.x),
                      .inner_begin = std::clamp(span.inner_begin, -reach.x, reach.x),
                      .inner_end = std::clamp(span.inner_end, -reach.x, reach.x),
                      .x_end = std::min(span.x_end, reach.x),
                      .tap = static_cast<std::uint32_t>(out.taps.size())};
        if (row.x_begin >= row.x_end) row.x_begin = row.inner_begin = row.inner_end = row.x_end = 0;
        const auto left_taps = static_cast<std::size_t>(span.inner_begin - span.x_begin);
        const bool all_taps = row.inner_end - row.inner_begin < shortest_inner_px;
        double sum = 0;
        for (int x = row.x_begin; x < row.x_end; ++x) {
            const bool inner = x >= span.inner_begin && x < span.inner_end;
            if (inner && !all_taps) {
                x = row.inner_end - 1;
                sum += static_cast<double>(out.inner) * (row.inner_end - row.inner_begin);
                continue;
            }
            const double share =
                inner ? source.inner_share()
                : x < span.inner_begin
                    ? span.edge_share[static_cast<std::size_t>(x - span.x_begin)]
                    : span.edge_share[left_taps + static_cast<std::size_t>(x - span.inner_end)];
            out.taps.push_back(static_cast<float>(share));
            sum += static_cast<double>(out.taps.back());
        }
        if (all_taps) row.inner_begin = row.inner_end = row.x_end;
        row.sum = static_cast<float>(sum);
        out.x_begin = std::min(out.x_begin, row.x_begin);
        out.x_end = std::max(out.x_end, row.x_end);
        out.rows.push_back(row);
    }
    out.taps.shrink_to_fit();
    return out;
}

}  // namespace

Kernel make_kernel(const Ellipse& ellipse, double phase_x, double phase_y, KernelReach reach) {
    return kernel_of_rows(EllipseRows(ellipse, phase_x, phase_y), reach);
}

Kernel make_kernel(const OutlineRows& outline, KernelReach reach) {
    return kernel_of_rows(outline, reach);
}

Kernel make_kernel(const ResponseGrid& grid, KernelReach reach) {
    Kernel out;
    out.y_begin = std::max(grid.y_begin, -reach.y);
    const int y_end = std::min(grid.y_begin + grid.height, reach.y);
    const int x_begin = std::max(grid.x_begin, -reach.x),
              x_end = std::max(x_begin, std::min(grid.x_begin + grid.width, reach.x));
    for (int y = out.y_begin; y < y_end; ++y) {
        KernelRow row{.x_begin = x_begin,
                      .inner_begin = x_end,
                      .inner_end = x_end,
                      .x_end = x_end,
                      .tap = static_cast<std::uint32_t>(out.taps.size())};
        double sum = 0;
        for (int x = x_begin; x < x_end; ++x) {
            out.taps.push_back(static_cast<float>(grid.at(x - grid.x_begin, y - grid.y_begin)));
            sum += static_cast<double>(out.taps.back());
        }
        row.sum = static_cast<float>(sum);
        out.rows.push_back(row);
    }
    out.x_begin = x_begin;
    out.x_end = x_end;
    return out;
}

std::int32_t KernelKey::finest(double extent_px) {
    std::int32_t out = 0;
    while (out + 1 < std::ssize(fineness_below_px) &&
           extent_px < fineness_below_px[static_cast<std::size_t>(out) + 1])
        ++out;
    return out;
}

KernelKey KernelKey::ellipse(const Ellipse& e, bool fine) {
    const double extent = std::max(e.half_width(), e.half_height);
    const double shrink = std::min(1.0, largest_ellipse_px / extent);
    KernelKey out{.is_disc = false, .fineness = fine ? finest(extent) : 0};
    const double step = out.step_px() / shrink;
    out.half_height = steps(e.half_height, step);
    out.half_chord = steps(e.half_chord, step);
    out.top_displacement = steps(e.shear * e.half_height, step);
    return out;
}

KernelKey KernelKey::map(const glm::dmat2& m, bool fine) {
    const double extent = std::max({std::abs(m[0].x), std::abs(m[0].y), std::abs(m[1].x), std::abs(m[1].y)});
    const double shrink = std::min(1.0, largest_ellipse_px / std::max(extent, 1.0));
    KernelKey out{.is_disc = false, .fineness = fine ? finest(extent) : 0, .is_map = true};
    const double step = out.step_px() / shrink;
    out.half_height = steps(m[0].x, step);
    out.half_chord = steps(m[0].y, step);
    out.top_displacement = steps(m[1].x, step);
    out.map_yy = steps(m[1].y, step);
    out.round_map(map_bits);
    return out;
}

KernelKey::Packed KernelKey::packed() const {
    const auto field = [](std::int32_t value, std::int32_t offset, int shift) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value + offset)) << shift;
    };
    const std::uint64_t phases = field(phase_x, phase_steps, 0) | field(phase_y, phase_steps, 6);
    constexpr std::int32_t sign = 1 << 16, cells = 1 << 14;
    const std::uint64_t more = (is_map ? field(map_yy, sign, 0) : 0) | (is_map ? std::uint64_t{1} << 17 : 0) |
                               (upside_down ? std::uint64_t{1} << 18 : 0) | field(fineness, 0, 62) |
                               field(std::clamp(cell_x, -cells, cells - 1), cells, 19) |
                               field(std::clamp(cell_y, -cells, cells - 1), cells, 35) |
                               field(cell_log2, 0, 51);
    if (is_disc) return {phases | static_cast<std::uint64_t>(level) << 12, more};
    const std::int32_t offset = is_map ? sign : 0;
    return {phases | field(half_height, offset, 12) | field(half_chord, offset, 29) |
                field(top_displacement, sign, 46) | std::uint64_t{1} << 63,
            more};
}

KernelTable::KernelTable(std::vector<double> disc_radius_px, KernelReach reach, const ResponseModel& model)
    : disc_radius_px_(std::move(disc_radius_px)),
      reach_(reach),
      model_(model),
      disc_used_(std::make_unique<std::atomic<bool>[]>(disc_radius_px_.size())) {
    for (std::uint32_t level = 0; level < disc_radius_px_.size(); ++level)
        keys_.push_back(KernelKey::disc(level));
}

std::uint32_t KernelTable::number_of(const KernelKey& key) {
    if (key == KernelKey::disc(key.level)) {
        use_disc(key.level);
        return key.level;
    }
    if (built_) {
        // No lock is needed, because `number_of_key_` does not change after `build`.
        return number_of_key_.at(key.packed());
    }
    // Each kernel has a number, its index in this table. Most keys have been requested before, so their
    // kernels already have numbers. Finding such a number needs no lock. A lock is only needed to give a new
    // kernel its number.
    const KernelKey::Packed packed = key.packed();
    if (const auto known = number_of_key_.find(packed); known != number_of_key_.end()) return known->second;
    const std::lock_guard lock(mutex_);
    const auto [entry, is_new] = number_of_key_.emplace(packed, static_cast<std::uint32_t>(keys_.size()));
    if (is_new) keys_.push_back(key);
    return entry->second;
}

Ellipse KernelTable::outline(const KernelKey& key) const {
    if (key.is_disc) return Ellipse::disc(disc_radius_px_[key.level]);
    // Converts the integers of the key back to sizes of the ellipse, in px. The integers are the sizes in
    // units of `step`, to which they were rounded. If a size was rounded to 0, half a unit is used instead,
    // so that the ellipse has an area.
    const double step = key.step_px();
    const auto size = [step](std::int32_t n) { return n > 0 ? n * step : step / 2; };
    if (key.half_height == 0 && key.half_chord == 0 && key.top_displacement == 0)
        return Ellipse::disc(smallest_ellipse_px);
    const double half_height = size(key.half_height);
    return {half_height, size(key.half_chord), key.top_displacement * step / half_height};
}

glm::dmat2 KernelTable::map_px(const KernelKey& key) const {
    if (key.is_disc)
        return glm::dmat2(key.upside_down ? -disc_radius_px_[key.level] : disc_radius_px_[key.level]);
    const double step = key.step_px();
    return {key.half_height * step, key.half_chord * step, key.top_displacement * step, key.map_yy * step};
}

std::size_t KernelTable::bytes_of(const KernelKey& key) const {
    if (!model_.is_round()) {
        const double reach = model_.reach_px(map_px(key)) + 1;
        const double rows = std::min(2 * reach, 2.0 * reach_.y) + 1,
                     columns = std::min(2 * reach, 2.0 * reach_.x) + 1;
        const double taps = model_.is_even() ? 4 * rows : rows * columns;
        return static_cast<std::size_t>(rows * sizeof(KernelRow) + taps * sizeof(float)) + sizeof(Kernel);
    }
    const Ellipse e = outline(key);
    const double rows = std::min(2 * e.half_height + 2, 2.0 * reach_.y + 1);
    const double outline_px = 4 * (e.half_height + e.half_width()) + 8;
    return static_cast<std::size_t>(rows * sizeof(KernelRow) + outline_px * sizeof(float)) + sizeof(Kernel);
}

ResponseRequest KernelTable::request(const KernelKey& key) const {
    const double cell_px = std::ldexp(1.0, key.cell_log2);
    return {.map_px = map_px(key),
            .place_px =
                key.cell_log2 == 0 ? glm::dvec2(0) : glm::dvec2(key.cell_x + 0.5, key.cell_y + 0.5) * cell_px,
            .phase_px = glm::dvec2(key.phase_x, key.phase_y) / static_cast<double>(KernelKey::phase_steps),
            .reach = reach_};
}

Kernel KernelTable::make(const KernelKey& key) const {
    const ResponseRequest r = request(key);
    return model_.is_round() ? make_kernel(outline(key), r.phase_px.x, r.phase_px.y, reach_)
                             : model_.kernel(r);
}

void KernelTable::make_channels(const std::vector<std::uint32_t>& numbers) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::size_t>> by_phase;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const KernelKey& key = keys_[numbers[i]];
        by_phase[{key.phase_x, key.phase_y}].push_back(i);
    }
    for (const auto& [phase, group] : by_phase) {
        std::vector<ResponseRequest> requests;
        for (const std::size_t i : group) requests.push_back(request(keys_[numbers[i]]));
        std::vector<std::array<Kernel, 3>> made = model_.channel_kernels(requests);
        for (std::size_t k = 0; k < group.size(); ++k) {
            for (std::size_t c = 0; c < 3; ++c) kernels_[3 * group[k] + c] = std::move(made[k][c]);
        }
    }
}

void Reach::include(const Reach& other) {
    dy_begin = std::min(dy_begin, other.dy_begin);
    dy_end = std::max(dy_end, other.dy_end);
    dx_begin = std::min(dx_begin, other.dx_begin);
    dx_end = std::max(dx_end, other.dx_end);
}

void KernelTable::build(std::size_t memory_limit_bytes) {
    coarsen_ellipses(memory_limit_bytes);
    channels_ = model_.has_channels() ? 3 : 1;
    kernel_of_.assign(keys_.size(), 0);
    std::unordered_map<KernelKey::Packed, std::uint32_t, KernelKey::PackedHash> place_of;
    std::vector<std::uint32_t> to_build;
    std::size_t total = 0;
    std::vector<bool> level_used(levels());
    for (std::uint32_t i = 0; i < keys_.size(); ++i) {
        if (i < levels() && !disc_used_[i].load(std::memory_order_relaxed)) continue;
        const auto [entry, is_new] =
            place_of.try_emplace(keys_[i].packed(), static_cast<std::uint32_t>(to_build.size()));
        kernel_of_[i] = entry->second;
        if (!is_new) continue;
        to_build.push_back(i);
        total += channels_ * bytes_of(keys_[i]);
        if (keys_[i].is_disc) level_used[keys_[i].level] = true;
    }
    place_of = {};
    require_memory(total, "the table of impulse responses");
    discs_used_ = static_cast<int>(std::count(level_used.begin(), level_used.end(), true));
    kernels_.resize(channels_ * to_build.size());
    if (model_.has_channels()) {
        make_channels(to_build);
    } else {
        parallel_for(
            to_build.size(), [&](std::size_t i) { kernels_[i] = make(keys_[to_build[i]]); }, 4);
    }
    reaches_.assign(kernel_of_.size(), {});
    for (std::uint32_t number = 0; number < numbers(); ++number) {
        for (std::size_t channel = 0; channel < channels_; ++channel) {
            const Kernel& k = kernel(number, channel);
            reaches_[number].include({k.y_begin, k.y_end(), k.x_begin, k.x_end});
        }
    }
    keys_ = {};
    built_ = true;
}

std::uint32_t KernelNumberCache::number_of(const KernelKey& key) {
    const KernelKey::Packed packed = key.packed();
    // Fibonacci hashing: the top bits of the hash select the entry.
    Entry& entry = entries_[KernelKey::PackedHash()(packed) >> (64 - entry_bits)];
    if (entry.key != packed) entry = {packed, table_->number_of(key)};
    return entry.number;
}

}  // namespace postlens
