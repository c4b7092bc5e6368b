// Chooses the rays with which the error of a light field's highlights is measured. Each ray starts in a pixel
// and passes through the lens to a highlight whose blur covers the pixel.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/sample_hash.h"
#include "focus/light_field/field_highlights.h"

namespace postlens {
namespace {

/// Number of random attempts to find a ray from a highlight through both the aperture and the pixel.
constexpr int attempts = 256;
/// Factor for the number of rays through a pixel. It applies if a sharp highlight moves past the pixel during
/// the exposure. More rays are needed, because many of them miss the moving highlight.
constexpr int passing_lines = 16;

/// Sharp moving highlights of one surface that pass near a pixel. Rays through the pixel are traced at the
/// instants at which they pass. Each of the `spans` is an interval, in fractions of the exposure, during
/// which one of the highlights is near the pixel.
struct Passing {
    NodeIdentity identity;
    double light = 0;
    std::vector<std::pair<double, double>> spans;
    double duration = 0;  ///< total duration of all spans, once they are joined

    void join_spans() {
        std::sort(spans.begin(), spans.end());
        std::size_t count = 0;
        for (const auto& span : spans) {
            if (count > 0 && span.first <= spans[count - 1].second) {
                spans[count - 1].second = std::max(spans[count - 1].second, span.second);
            } else {
                spans[count++] = span;
            }
        }
        spans.resize(count);
        for (const auto& [begin, end] : spans) duration += end - begin;
    }
    [[nodiscard]] double instant(double part) const {
        double left = part * duration;
        for (const auto& [begin, end] : spans) {
            if (left < end - begin) return begin + left;
            left -= end - begin;
        }
        return spans.back().second;
    }
};

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
    const Kernel& kernel = kernel_of(s);
    if (y < s.y + kernel.y_begin || y >= s.y + kernel.y_end()) return 0;
    const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
    const int column = x - s.x;
    return column >= row.x_begin && column < row.x_end ? kernel.at(row, column) : 0;
}

glm::dvec2 FieldHighlights::point_of(const Source& s, double choice, const glm::dvec2& place) const {
    const std::span parts(parts_.data() + s.first_part, s.parts);
    const SourcePart& part = *std::lower_bound(
        parts.begin(), std::prev(parts.end()), choice * static_cast<double>(parts.back().area_until),
        [](const SourcePart& p, double until) { return static_cast<double>(p.area_until) < until; });
    return s.at + glm::dvec2(part.at) + glm::dvec2(part.size) * (place - 0.5);
}

bool FieldHighlights::passes_near(const Source& s, int x, int y) const {
    if (s.u < 0 || !s.by_all) return false;
    const Kernel& k = kernel_of(s);
    return x >= s.x + k.x_begin - passing_px && x < s.x + k.x_end + passing_px &&
           y >= s.y + k.y_begin - passing_px && y < s.y + k.y_end() + passing_px;
}

std::vector<std::uint32_t> FieldHighlights::reaching(int x, int y, int width, int height) const {
    std::vector<std::uint32_t> out;
    const RasterWindow part{x, x + width, y, y + height};
    any_near(x, y, [&](const Reach& r) {
        if (meet(r.pixels, part)) out.push_back(r.source);
        return false;
    });
    std::sort(out.begin(), out.end());
    return out;
}

void FieldHighlights::aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
                          std::vector<Lights::Line>& lines) const {
    struct Reached {
        std::uint32_t source;
        double light_until;
    };
    std::vector<Reached> reached;
    std::vector<Passing> passing;
    double light = 0, of_passing = 0;
    for (const std::uint32_t i : sources) {
        const Source& s = sources_[i];
        if (s.u >= 0 && s.by_all) {
            if (!passes_near(s, x, y)) continue;
            const NodeIdentity identity{s.key.path, s.key.parent_id, s.key.id};
            auto of = std::find_if(passing.begin(), passing.end(),
                                   [&](const Passing& p) { return p.identity == identity; });
            if (of == passing.end()) of = passing.insert(passing.end(), {.identity = identity});
            const double begin = std::floor(s.u / s.exposure) * s.exposure;
            of->light += s.light;
            of->spans.emplace_back(begin, begin + s.exposure);
            of_passing += s.light;
            continue;
        }
        const double share = response(s, x, y);
        if (!(share > 0)) continue;
        light += share * s.light;
        reached.push_back({i, light});
    }
    const double all = light + of_passing;
    if (!(all > 0)) return;
    for (Passing& p : passing) p.join_spans();
    Randoms random(seed);
    const int lines_wanted = passing.empty() ? count : passing_lines * count;
    for (int n = 0; n < lines_wanted; ++n) {
        // Chooses highlights with a probability proportional to their light.
        double chosen = (n + random.next()) / lines_wanted * all;
        if (chosen >= light && !passing.empty()) {
            // Chooses a random ray through the pixel and the lens, at an instant at which a moving highlight
            // is near. The ray is not aimed at the recorded parts of the highlight, because it would then
            // never find parts that the sample file lacks.
            chosen -= light;
            std::size_t k = 0;
            for (; k + 1 < passing.size() && chosen >= passing[k].light; ++k) chosen -= passing[k].light;
            const Passing& p = passing[k];
            const glm::dvec2 place = random.next_two(), uv = random.next_two();
            lines.push_back({.line = {.place = place,
                                      .lens = aperture_.sample(uv.x, uv.y),
                                      .light_before = p.instant(random.next())},
                             .highlight = p.identity,
                             .scale = all / p.light * p.duration});
            continue;
        }
        const Reached& r =
            *std::lower_bound(reached.begin(), std::prev(reached.end()), chosen,
                              [](const Reached& a, double value) { return a.light_until < value; });
        const Source& s = sources_[r.source];
        const double light_before = s.u >= 0 ? s.u : random.next();
        Lights::Line aimed;
        // A ray from the highlight must pass through both the lens and the pixel. One of these positions is
        // chosen at random, and determines the other. If the blur is smaller than a pixel, this is the lens
        // point, because most rays through the lens then hit the pixel.
        const bool from_lens = std::abs(glm::determinant(s.px_from_lens)) < 1;
        for (int attempt = 0; attempt < attempts; ++attempt) {
            const double choice = random.next();
            const glm::dvec2 from = point_of(s, choice, random.next_two()), pixel(x, y);
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
            aimed.scale = all / s.light * s.area * s.exposure;
            lines.push_back(aimed);
            break;
        }
    }
}

}  // namespace postlens
