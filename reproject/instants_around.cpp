#include "reproject/instants_around.h"

#include <algorithm>
#include <numeric>

namespace postlens {

std::vector<InstantShare> instants_around(const std::vector<double>& instants_s, double time_s) {
    std::vector<std::size_t> by_time(instants_s.size());
    std::iota(by_time.begin(), by_time.end(), std::size_t{0});
    std::sort(by_time.begin(), by_time.end(),
              [&](std::size_t a, std::size_t b) { return instants_s[a] < instants_s[b]; });
    const auto after = std::upper_bound(by_time.begin(), by_time.end(), time_s,
                                        [&](double t, std::size_t i) { return t < instants_s[i]; });
    if (after == by_time.begin()) return {{by_time.front(), 1}};
    if (after == by_time.end()) return {{by_time.back(), 1}};
    const std::size_t a = *(after - 1), b = *after;
    const double share = (time_s - instants_s[a]) / (instants_s[b] - instants_s[a]);
    return {{a, 1 - share}, {b, share}};
}

}  // namespace postlens
