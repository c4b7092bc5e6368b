#include "focus/foreign/border_extension.h"

#include <algorithm>
#include <cmath>

#include "core/threads.h"
#include "focus/foreign/behind_fill.h"
#include "focus/foreign/stack_facets.h"

namespace postlens {
namespace {

/// Largest distance to which samples continue, in px.
constexpr double most_continued_px = 512;

}  // namespace

BorderExtension::BorderExtension(const ForeignPicture& picture, const FocusGeometry& geometry,
                                 double aberration_px)
    : p_(picture), geometry_(geometry), aberration_px_(aberration_px), window_(known_pixels(picture)) {
    if (p_.x_begin >= p_.x_end || p_.y_begin >= p_.y_end) return;
    if (p_.x_begin == window_.x_begin) left_ = side(p_.x_begin, p_.y_begin, 0, 1);
    if (p_.x_end == window_.x_end) right_ = side(p_.x_end - 1, p_.y_begin, 0, 1);
    if (p_.y_begin == window_.y_begin) top_ = side(p_.x_begin, p_.y_begin, 1, 0);
    if (p_.y_end == window_.y_end) bottom_ = side(p_.x_begin, p_.y_end - 1, 1, 0);
    const auto longest = [](const Side& side) {
        int out = 0;
        for (const auto& pixel : side) {
            for (const Continued& c : pixel) out = std::max(out, c.length_px);
        }
        return out;
    };
    window_ = {window_.x_begin - longest(left_), window_.x_end + longest(right_),
               window_.y_begin - longest(top_), window_.y_end + longest(bottom_)};
}

BorderExtension::Side BorderExtension::side(int x, int y, int along_x, int along_y) const {
    // Direction from this side of the image to its interior.
    const int dx = along_x != 0      ? 0
                   : x == p_.x_begin ? 1
                                     : -1,
              dy = along_y != 0      ? 0
                   : y == p_.y_begin ? 1
                                     : -1;
    Side out(static_cast<std::size_t>(along_x != 0 ? p_.x_end - p_.x_begin : p_.y_end - p_.y_begin));
    parallel_for(out.size(), [&](std::size_t i) {
        const int u = x + along_x * static_cast<int>(i), v = y + along_y * static_cast<int>(i);
        for (const StackSample& s : p_.stack(u, v)) out[i].push_back(continue_inwards(s, u, v, dx, dy));
    });
    return out;
}

BorderExtension::Continued BorderExtension::continue_inwards(const StackSample& sample, int x, int y, int dx,
                                                             int dy) const {
    const double radius_px =
        std::abs(geometry_.coc_diameter_px(static_cast<double>(sample.spread_inverse_z())) / 2);
    const int most = static_cast<int>(std::ceil(std::min(radius_px + aberration_px_, most_continued_px)));
    Continued out{sample};
    double r = 0, g = 0, b = 0, alpha = 0;
    for (const StackSample* s = &sample; s != nullptr && out.length_px < most; ++out.length_px) {
        r += static_cast<double>(s->r);
        g += static_cast<double>(s->g);
        b += static_cast<double>(s->b);
        alpha += static_cast<double>(s->alpha);
        s = next_of(*s, x += dx, y += dy);
    }
    if (out.length_px == 0) return out;
    out.sample.r = static_cast<float>(r / out.length_px);
    out.sample.g = static_cast<float>(g / out.length_px);
    out.sample.b = static_cast<float>(b / out.length_px);
    out.sample.alpha = static_cast<float>(alpha / out.length_px);
    return out;
}

/// Returns the sample of pixel (x, y) that lies on the same surface as `sample`, a sample of a neighbouring
/// pixel. If there are several such samples, returns the one whose inverse depth is nearest to that of
/// `sample`; if there is none, null.
const StackSample* BorderExtension::next_of(const StackSample& sample, int x, int y) const {
    if (!p_.stores(x, y)) return nullptr;
    const auto apart = [&](const StackSample& s) {
        return std::abs(s.spread_inverse_z() - sample.spread_inverse_z());
    };
    const StackSample* best = nullptr;
    for (const StackSample& s : p_.stack(x, y)) {
        if (are_one_surface(s, sample, geometry_) && (best == nullptr || apart(s) < apart(*best))) best = &s;
    }
    return best;
}

std::optional<std::size_t> BorderExtension::continued(int x, int y, std::vector<StackSample>& stack) const {
    stack.clear();
    const int u = std::clamp(x, p_.x_begin, p_.x_end - 1), v = std::clamp(y, p_.y_begin, p_.y_end - 1);
    const Side* across_x = x < u ? &left_ : x > u ? &right_ : nullptr;
    const Side* across_y = y < v ? &top_ : y > v ? &bottom_ : nullptr;
    if ((across_x != nullptr && across_x->empty()) || (across_y != nullptr && across_y->empty())) return {};
    const std::vector<Continued>* in_row =
        across_x == nullptr ? nullptr : &(*across_x)[static_cast<std::size_t>(v - p_.y_begin)];
    const std::vector<Continued>* in_column =
        across_y == nullptr ? nullptr : &(*across_y)[static_cast<std::size_t>(u - p_.x_begin)];
    const std::vector<Continued>& samples = in_row != nullptr ? *in_row : *in_column;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (in_row != nullptr && (*in_row)[i].length_px < std::abs(x - u)) continue;
        if (in_column != nullptr && (*in_column)[i].length_px < std::abs(y - v)) continue;
        stack.push_back(samples[i].sample);
    }
    if (stack.empty()) return {};
    return p_.pixel_at(u, v);
}

}  // namespace postlens
