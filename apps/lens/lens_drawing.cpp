#include "apps/lens/lens_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace postlens {
namespace {

using Point = Drawing::Point;

constexpr Drawing::Colour black{30, 30, 30}, grey{150, 150, 150}, light{225, 225, 225}, glass{214, 230, 245},
    glass_edge{70, 100, 140};
// Colours that most colour-blind readers distinguish.
constexpr std::array<Drawing::Colour, 5> ray_colours{
    {{0, 114, 178}, {0, 158, 115}, {213, 94, 0}, {204, 121, 167}, {120, 94, 40}}};

// Returns a round distance between the ticks of an axis, at least `span` / `count`. It is 1, 2 or 5 times a
// power of ten.
double round_step(double span, double count) {
    const double raw = span / count, power = std::pow(10, std::floor(std::log10(raw)));
    for (const double f : {1.0, 2.0, 5.0}) {
        if (f * power >= raw) return f * power;
    }
    return 10 * power;
}

}  // namespace

Drawing draw_section(const LensSection& section, const Prescription& lens, const TracedLens& traced) {
    constexpr double width = 1200, margin = 24, caption = 44;
    const double z0 = section.front_z_mm, z1 = section.film_z_mm + 0.03 * (section.film_z_mm - z0);
    const double height_mm = std::max(section.height_mm, 1e-6);
    const double scale = std::min((width - 2 * margin) / (z1 - z0), 425 / height_mm);
    const double middle = margin + height_mm * scale;
    Drawing out(static_cast<int>(width), static_cast<int>(2 * middle + caption));
    const double left = 0.5 * (width - (z1 - z0) * scale);
    const auto at = [&](glm::dvec2 p) { return Point{left + (p.x - z0) * scale, middle - p.y * scale}; };
    const auto polyline = [&](const std::vector<glm::dvec2>& points) {
        std::vector<Point> px;
        px.reserve(points.size());
        for (const auto& p : points) px.push_back(at(p));
        return px;
    };
    out.line({at({z0, 0}), at({z1, 0})}, grey, 1, true);
    for (const auto& element : section.glass) out.area(polyline(element), glass, glass_edge, 1.2);
    for (const auto& plane : section.planes) out.line(polyline(plane), grey, 1);
    for (const auto& ray : section.rays) {
        out.line(polyline(ray.points), ray_colours[ray.field % ray_colours.size()], 1);
    }
    for (const auto& blade : section.stop) out.line(polyline(blade), black, 4);
    double film = std::max(0.1 * height_mm, traced.settings().film_radius_mm);
    for (const auto& ray : section.rays) film = std::max(film, std::abs(ray.points.back().y));
    film = std::min(height_mm, film);
    out.line({at({section.film_z_mm, film}), at({section.film_z_mm, -film})}, black, 2.5);
    const FirstOrder& f = traced.first_order();
    const auto mark = [&](double z, const char* name, double below) {
        if (!(z >= z0 && z <= z1)) return;
        const Point p = at({z, 0});
        out.line({{p.x, p.y - 7}, {p.x, p.y + 7}}, black, 2);
        out.text({p.x, p.y + below}, 13, name, Drawing::Anchor::middle);
    };
    mark(f.entrance_pupil_z_mm, "EP", 22);
    mark(traced.stack().last_vertex_z_mm() + f.exit_pupil_z_mm, "XP", -12);
    out.text(
        {margin, 2 * middle + 8}, 17,
        fmt::format("{}: EFL {:.5g} mm, f/{:.3g}, entrance pupil (EP) {:.4g} mm, exit pupil (XP) {:.4g} mm",
                    lens.name.empty() ? "lens" : lens.name.substr(0, 48), f.efl_mm, traced.f_number(),
                    f.entrance_pupil_diameter_mm * f.f_number / traced.f_number(),
                    f.exit_pupil_diameter_mm * f.f_number / traced.f_number()));
    const double bar_mm = round_step(z1 - z0, 16);
    const Point end{width - margin, 2 * middle + 18};
    out.line({{end.x - bar_mm * scale, end.y}, end}, black, 2);
    out.text({end.x, end.y - 6}, 14, fmt::format("{:g} mm", bar_mm), Drawing::Anchor::end);
    return out;
}

Drawing draw_spots(const std::vector<Spot>& spots) {
    constexpr double cell = 280, top = 30, bottom = 50;
    double reach = 1e-6;
    for (const Spot& s : spots) {
        for (const auto& p : s.points_mm) reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
    }
    Drawing out(static_cast<int>(cell * static_cast<double>(std::max<std::size_t>(spots.size(), 1))),
                static_cast<int>(cell + top + bottom));
    const double scale = 0.46 * cell / reach;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const double x = cell * (static_cast<double>(i) + 0.5), y = top + 0.5 * cell;
        out.line({{x - 0.48 * cell, y}, {x + 0.48 * cell, y}}, light);
        out.line({{x, y - 0.48 * cell}, {x, y + 0.48 * cell}}, light);
        for (const auto& p : spots[i].points_mm) {
            out.dot({x + p.x * scale, y - p.y * scale}, 1, ray_colours[i % ray_colours.size()]);
        }
        out.text({x, 20}, 15, spots[i].title, Drawing::Anchor::middle);
        out.text({x, top + cell + 16}, 14,
                 spots[i].points_mm.empty() ? std::string("no light")
                                            : fmt::format("RMS radius {:.4g} um", 1000 * spots[i].rms_mm),
                 Drawing::Anchor::middle);
    }
    const double bar_mm = round_step(reach, 1.5);
    const Point from{12, top + cell + 38};
    out.line({from, {from.x + bar_mm * scale, from.y}}, black, 2);
    out.text({from.x + bar_mm * scale + 8, from.y + 5}, 14, fmt::format("{:g} um", 1000 * bar_mm));
    return out;
}

Drawing draw_curves(const std::vector<Curve>& curves, const std::string& x_title) {
    constexpr double width = 720, panel = 240, left = 80, right = 20, top = 34, bottom = 30;
    Drawing out(static_cast<int>(width), static_cast<int>(panel * static_cast<double>(curves.size()) + 20));
    for (std::size_t c = 0; c < curves.size(); ++c) {
        const Curve& curve = curves[c];
        const double y0 = panel * static_cast<double>(c) + top, height = panel - top - bottom;
        double low = 0, high = 1e-9, right_x = 1e-9;
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            if (!std::isfinite(curve.y[i])) continue;
            low = std::min(low, curve.y[i]);
            high = std::max(high, curve.y[i]);
            right_x = std::max(right_x, curve.x[i]);
        }
        const double step = round_step(high - low, 4), x_step = round_step(right_x, 8);
        low = std::floor(low / step + 1e-9) * step;
        high = std::ceil(high / step - 0.02) * step;  // tolerate a curve slightly above the top line
        const auto at = [&](double x, double y) {
            return Point{left + x / right_x * (width - left - right),
                         y0 + (high - y) / (high - low) * height};
        };
        for (double y = low; y <= high + 0.5 * step; y += step) {
            out.line({at(0, y), at(right_x, y)}, light);
            out.text({left - 8, at(0, y).y + 5}, 13, fmt::format("{:.4g}", std::abs(y) < 1e-9 * step ? 0 : y),
                     Drawing::Anchor::end);
        }
        for (double x = 0; x <= right_x * (1 + 1e-9); x += x_step) {
            out.line({at(x, low), at(x, high)}, light);
            out.text({at(x, low).x, y0 + height + 18}, 13, fmt::format("{:.4g}", x), Drawing::Anchor::middle);
        }
        // The line is interrupted where the curve is not finite.
        std::vector<Point> points;
        for (std::size_t i = 0; i <= curve.x.size(); ++i) {
            if (i < curve.x.size() && std::isfinite(curve.y[i])) {
                points.push_back(at(curve.x[i], curve.y[i]));
            } else if (points.size() > 1) {
                out.line(std::exchange(points, {}), ray_colours[c % ray_colours.size()], 2);
            }
        }
        out.text({left, y0 - 10}, 15,
                 fmt::format("{}{}", curve.title, curve.unit.empty() ? "" : ", " + curve.unit));
    }
    out.text({0.5 * width, panel * static_cast<double>(curves.size()) + 12}, 14, x_title,
             Drawing::Anchor::middle);
    return out;
}

}  // namespace postlens
