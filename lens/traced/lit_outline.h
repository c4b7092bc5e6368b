// Finds the outline of the region in which light passes a lens, by testing single rays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

namespace postlens {

/// Finds the outline of the region in which rays from an object point pass a lens. The region lies in a
/// plane, and must be star-shaped and symmetric about x = 0. `passes(p)` tells whether the ray through the
/// point p of this plane passes the lens. `scale` is the approximate width of the region.
template <class Passes>
class LitOutline {
  public:
    static constexpr std::size_t spokes = 48;  ///< directions over half a turn, from +y to -y
    using Edge = std::array<glm::dvec2, spokes + 1>;

    LitOutline(Passes passes, double scale) : passes_(std::move(passes)), scale_(scale) {}

    /// Searches for the region in which rays pass the lens, beginning at the point `near`. Sets `near` to the
    /// region's centre, and `edge` to points on its outline. Returns false if no ray passes.
    [[nodiscard]] bool find(glm::dvec2& near, Edge& edge) const {
        if (!passes_(near) && !search(near)) return false;
        find_edge(near, edge);
        if (const glm::dvec2 centroid(0, centroid_y(edge)); passes_(centroid)) {
            near = centroid;
            find_edge(near, edge);
        }
        return true;
    }

  private:
    /// The edge of the region in which rays pass the lens is found by bisection, along each spoke from the
    /// region's centre. This is the number of bisection steps. They reduce the initial interval to 2^-18 of
    /// its length.
    static constexpr int halvings = 18;
    static constexpr int search_cells = 24;

    static glm::dvec2 direction(std::size_t spoke) {
        const double angle = std::numbers::pi * static_cast<double>(spoke) / spokes;
        return {std::sin(angle), std::cos(angle)};
    }

    [[nodiscard]] bool search(glm::dvec2& near) const {
        std::vector<glm::dvec2> found;
        glm::dvec2 sum(0);
        const glm::dvec2 low = near - 2.5 * scale_;
        for (int j = 0; j <= search_cells; ++j) {
            for (int i = 0; i <= search_cells; ++i) {
                const glm::dvec2 p = low + 5 * scale_ / search_cells * glm::dvec2(i, j);
                if (!passes_(p)) continue;
                found.push_back(p);
                sum += p;
            }
        }
        if (found.empty()) return false;
        const glm::dvec2 mean = sum / static_cast<double>(found.size());
        near = *std::min_element(found.begin(), found.end(), [&](const glm::dvec2& a, const glm::dvec2& b) {
            return glm::length(a - mean) < glm::length(b - mean);
        });
        near.x = 0;
        return passes_(near);
    }

    void find_edge(const glm::dvec2& middle, Edge& out) const {
        for (std::size_t j = 0; j <= spokes; ++j) {
            const glm::dvec2 step = scale_ * direction(j);
            double inside = 0, outside = 3;
            while (outside < 1e3 && passes_(middle + outside * step)) outside *= 2;
            for (int i = 0; i < halvings; ++i) {
                const double at = (inside + outside) / 2;
                (passes_(middle + at * step) ? inside : outside) = at;
            }
            out[j] = middle + inside * step;
        }
    }

    // Returns the coordinate y of the centroid of a region that is symmetric about x = 0. Its coordinate x is
    // 0. `edge` is the outline of the half with x >= 0.
    [[nodiscard]] static double centroid_y(const Edge& edge) {
        double area = 0, moment = 0;
        for (std::size_t j = 0; j < spokes; ++j) {
            const glm::dvec2 &a = edge[j], &b = edge[j + 1];
            area += (a.x + b.x) / 2 * (a.y - b.y);
            moment += (a.y - b.y) * (a.x * (2 * a.y + b.y) + b.x * (a.y + 2 * b.y)) / 6;
        }
        return area > 0 ? moment / area : edge[0].y;
    }

    Passes passes_;
    double scale_;
};

}  // namespace postlens
