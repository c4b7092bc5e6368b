#include "pictures/foreign/deep_volumes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

namespace postlens {
namespace {

bool is_volume(const DeepSample& s) {
    return s.z >= 0 && s.z_back > s.z && std::isfinite(s.z_back) && s.alpha < 1;
}

/// Emission (red, green, blue) and density of a volume, each per unit of length.
using Rates = std::array<double, 4>;

Rates rates_of(const DeepSample& s) {
    const double length = static_cast<double>(s.z_back) - static_cast<double>(s.z);
    const auto alpha = static_cast<double>(s.alpha);
    const double depth = -std::log1p(-alpha);
    const double gain = alpha > 0 ? depth / alpha : 1;
    return {static_cast<double>(s.r) * gain / length, static_cast<double>(s.g) * gain / length,
            static_cast<double>(s.b) * gain / length, depth / length};
}

/// A depth at which a volume begins or ends, or at which there is a surface.
struct Event {
    float z;
    enum class Kind : std::uint8_t { ends, begins, surface } kind;  ///< events at equal depth have this order
    std::size_t volume = 0;
};

}  // namespace

void tidy_volumes(std::vector<DeepSample>& samples) {
    std::vector<DeepSample> volumes, out;
    for (const DeepSample& s : samples) (is_volume(s) ? volumes : out).push_back(s);
    if (volumes.empty()) return;
    // Sorts the deep samples, so that the result does not depend on their order in the file, not even by
    // rounding errors.
    std::sort(volumes.begin(), volumes.end(), [](const DeepSample& a, const DeepSample& b) {
        const auto key = [](const DeepSample& s) {
            // Colours may be NaN, whose order is not defined, so they are sorted by their bits.
            const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
            return std::tuple(s.z, s.z_back, s.alpha, bits(s.r), bits(s.g), bits(s.b), s.id);
        };
        return key(a) < key(b);
    });
    std::vector<Event> events;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        events.push_back({volumes[i].z, Event::Kind::begins, i});
        events.push_back({volumes[i].z_back, Event::Kind::ends, i});
    }
    for (const DeepSample& s : out) {
        if (s.z > 0 && std::isfinite(s.z)) events.push_back({s.z, Event::Kind::surface});
    }
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
        return std::tie(a.z, a.kind, a.volume) < std::tie(b.z, b.kind, b.volume);
    });
    // Determines `mixed`: whether the volumes of this pixel must be divided into slices. This is necessary if
    // a surface or another volume begins inside a volume. `around` is the number of volumes that have begun
    // and have not ended.
    bool mixed = false;
    int around = 0;
    for (const Event& e : events) {
        mixed = mixed || (around > 0 && e.kind != Event::Kind::ends);
        around += e.kind == Event::Kind::begins ? 1 : e.kind == Event::Kind::ends ? -1 : 0;
    }
    if (!mixed) return;
    std::set<std::pair<double, std::size_t>> inside;  // volumes at this depth, by density
    Rates sum{};
    for (std::size_t i = 0; i < events.size(); ++i) {
        const Event& e = events[i];
        if (e.kind != Event::Kind::surface) {
            const bool begins = e.kind == Event::Kind::begins;
            const Rates rates = rates_of(volumes[e.volume]);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += begins ? rates[c] : -rates[c];
            if (begins) {
                inside.emplace(rates[3], e.volume);
            } else {
                inside.erase({rates[3], e.volume});
            }
        }
        if (inside.empty()) {
            sum = {};
            continue;
        }
        const float next = events[i + 1].z;
        if (!(next > e.z)) continue;
        const double length = static_cast<double>(next) - static_cast<double>(e.z);
        const double depth = std::max(sum[3], 0.0) * length;
        const double alpha = -std::expm1(-depth);
        const double gain = length * (depth > 0 ? alpha / depth : 1);
        out.push_back({e.z, next, static_cast<float>(sum[0] * gain), static_cast<float>(sum[1] * gain),
                       static_cast<float>(sum[2] * gain), static_cast<float>(alpha),
                       volumes[inside.rbegin()->second].id});
    }
    samples = std::move(out);
}

}  // namespace postlens
