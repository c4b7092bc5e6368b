// Aims lines of sight at the highlights of a light field, to check their light with rays.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/sample_hash.h"
#include "focus/light_field/field_highlights.h"

namespace postlens {
namespace {

/// Attempts to find a lens point for a line.
constexpr int attempts = 256;

/// Random numbers in [0, 1).
class Randoms {
  public:
    explicit Randoms(std::uint64_t key) : key_(key) {}
    double next() { return static_cast<double>(unit_float(random_word(key_, counter_++))); }
    glm::dvec2 next_two() {
        const double x = next();
        return {x, next()};
    }

  private:
    std::uint64_t key_;
    std::uint32_t counter_ = 0;
};

}  // namespace

double FieldHighlights::response(const Source& s, int x, int y) const {
    const Kernel& kernel = (*kernels_)[s.kernel];
    if (y < s.y + kernel.y_begin || y >= s.y + kernel.y_end()) return 0;
    const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
    const int column = x - s.x;
    return column >= row.x_begin && column < row.x_end ? kernel.at(row, column) : 0;
}

std::vector<std::uint32_t> FieldHighlights::reaching(int x, int y, int width, int height) const {
    std::vector<std::uint32_t> out;
    const RasterWindow part{x, x + width, y, y + height};
    for (const Reach& r : rows_[static_cast<std::size_t>(y / band_px)]) {
        if (meet(r.pixels, part)) out.push_back(r.source);
    }
    return out;
}

void FieldHighlights::aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                          std::vector<Lights::Line>& lines) const {
    struct Reached {
        std::uint32_t source;
        double light_until;
    };
    std::vector<Reached> reached;
    double light = 0;
    for (const std::uint32_t i : sources) {
        const double share = response(sources_[i], x, y);
        if (!(share > 0)) continue;
        light += share * sources_[i].light;
        reached.push_back({i, light});
    }
    if (!(light > 0)) return;
    Randoms random(seed);
    for (int n = 0; n < count; ++n) {
        // Sources are chosen in proportion to their light.
        const double chosen = (n + random.next()) / count * light;
        const Reached& r =
            *std::lower_bound(reached.begin(), std::prev(reached.end()), chosen,
                              [](const Reached& a, double value) { return a.light_until < value; });
        const Source& s = sources_[r.source];
        const double light_before = s.u >= 0 ? s.u : random.next();
        Lights::Line aimed;
        // If the response covers less than a pixel, few lines between the highlight and the pixel pass the
        // lens; if it covers more, few lines through the lens meet the pixel.
        const bool from_lens = std::abs(glm::determinant(s.px_from_lens)) < 1;
        for (int attempt = 0; attempt < attempts; ++attempt) {
            const glm::dvec2 from = s.at + std::sqrt(s.area) * (random.next_two() - 0.5), pixel(x, y);
            glm::dvec2 place, lens;
            if (from_lens) {
                const glm::dvec2 uv = random.next_two();
                lens = aperture_.sample(uv.x, uv.y);
                place = from + s.px_from_lens * lens - pixel;
                if (glm::floor(place) != glm::dvec2(0)) continue;
            } else {
                place = random.next_two();
                lens = s.lens_from_px * (pixel + place - from);
                if (random.next() >= aperture_.transmittance(lens)) continue;
            }
            aimed.line = {.place = place, .lens = lens, .light_before = light_before};
            aimed.highlight = {s.key.path, s.key.parent_id, s.key.id};
            aimed.scale = light / s.light * s.area * s.exposure;
            lines.push_back(aimed);
            break;
        }
    }
}

}  // namespace postlens
