#include "focus/light_field/square_search.h"

#include <cstddef>

#include "core/sample_hash.h"

namespace postlens {

void SquareSearch::search(std::vector<Square>& squares, double side_px) {
    std::vector<SightLine> lines;
    lines.reserve(squares.size() * rays_per_square);
    for (const Square& square : squares) {
        for (int i = 0; i < rays_per_square; ++i) {
            const auto k = static_cast<std::uint32_t>(lines.size());
            const auto within = [&](int step, std::uint32_t counter) {
                return (step + static_cast<double>(unit_float(random_word(seed_, counter)))) / square_rays;
            };
            lines.push_back({.x = pixel_.second,
                             .y = pixel_.first,
                             .place = square.begin + side_px * glm::dvec2(within(i % square_rays, 2 * k),
                                                                          within(i / square_rays, 2 * k + 1)),
                             .view = k});
        }
    }
    const std::vector<NodeIdentity> nodes(lines.size(), node_);
    std::vector<std::array<float, 3>> radiance(lines.size());
    rays_.trace_elsewhere(lines, nodes, less_, radiance);
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (radiance[k] == std::array<float, 3>{}) continue;
        Square& square = squares[k / rays_per_square];
        for (std::size_t c = 0; c < 3; ++c) square.rgb[c] += radiance[k][c];
        square.at += lines[k].place;
        ++square.found;
    }
    seed_ = mix64(seed_ + 1);
}

void SquareGrid::search(SquareSearch& by) {
    if (with_ring_) {
        by.search(squares_, side_px_);
        return;
    }
    std::vector<Square> inner;
    for (int y = 0; y < size_.y; ++y) {
        for (int x = 0; x < size_.x; ++x) inner.push_back(at(x, y));
    }
    by.search(inner, side_px_);
    for (int y = 0; y < size_.y; ++y) {
        for (int x = 0; x < size_.x; ++x) at(x, y) = inner[static_cast<std::size_t>(y * size_.x + x)];
    }
}

void SquareGrid::divide(SquareSearch& by, const std::function<bool(const Square&)>& has_record) {
    std::vector<glm::ivec2> next;
    for (int y = 0; y < size_.y; ++y) {
        for (int x = 0; x < size_.x; ++x) {
            if (is_edge(x, y) || has_record(at(x, y))) next.emplace_back(x, y);
        }
    }
    const int n = area_.divided;
    while (!next.empty()) {
        std::vector<Square> fine;
        for (const glm::ivec2& p : next) {
            for (int i = 0; i < n * n; ++i)
                fine.push_back({.begin = at(p.x, p.y).begin + side_px_ / n * glm::dvec2(i % n, i / n)});
        }
        by.search(fine, side_px_ / n);
        auto from = fine.begin();
        for (const glm::ivec2& p : next) {
            divided(p.x, p.y).assign(from, from + n * n);
            from += n * n;
        }
        std::vector<glm::ivec2> more;
        for (const glm::ivec2& p : next) {
            if (std::ranges::none_of(divided(p.x, p.y), &Square::found)) continue;
            for (int k = 0; k < 9; ++k) {
                const glm::ivec2 q(p.x + k % 3 - 1, p.y + k / 3 - 1);
                if (inside(q.x, q.y) && divided(q.x, q.y).empty() && at(q.x, q.y).found < rays_per_square &&
                    std::ranges::find(more, q) == more.end())
                    more.push_back(q);
            }
        }
        next = std::move(more);
    }
}

bool SquareGrid::touches(int axis, int side) {
    const int across = axis == 0 ? size_.y : size_.x, last = (axis == 0 ? size_.x : size_.y) - 1,
              border = side < 0 ? 0 : last, n = area_.divided;
    for (int i = -1; i <= across; ++i) {
        const auto place = [&](int along) { return axis == 0 ? glm::ivec2(along, i) : glm::ivec2(i, along); };
        const glm::ivec2 outer = place(border + side), p = place(border);
        if (at(outer.x, outer.y).found > 0) return true;
        if (!inside(p.x, p.y)) continue;
        const std::vector<Square>& fine = divided(p.x, p.y);
        if (fine.empty() && at(p.x, p.y).found > 0) return true;
        for (std::size_t k = 0; k < fine.size(); ++k) {
            const int step = static_cast<int>(k) % n, row = static_cast<int>(k) / n,
                      along = axis == 0 ? step : row;
            if (along == (side < 0 ? 0 : n - 1) && fine[k].found > 0) return true;
        }
    }
    return false;
}

bool SquareGrid::is_edge(int x, int y) {
    const int found = at(x, y).found;
    if (found % rays_per_square != 0) return true;
    for (int k = 0; k < 9; ++k) {
        if (at(x + k % 3 - 1, y + k / 3 - 1).found != found) return true;
    }
    return false;
}

}  // namespace postlens
