#include "lens/shutter_curve.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/fingerprint.h"
#include "core/text.h"

namespace postlens {
namespace {

constexpr std::size_t most_points = 1'000'000;

// Reads a line of two numbers. Returns false for an empty line or a comment.
bool parse_line(std::string_view line, const std::string& where, std::pair<double, double>& out) {
    line = line.substr(0, line.find('#'));
    double values[2] = {};
    int count = 0;
    for (std::size_t at = 0; (at = line.find_first_not_of(" \t\r,;", at)) != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(" \t\r,;", at), line.size());
        const std::string_view word = line.substr(at, end - at);
        double value = 0;
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(value)) {
            fail(ExitCode::invalid_input, "{}: not a finite number (got {}; expected time and transmission)",
                 where, excerpt(word));
        }
        if (count < 2) values[count] = value;
        ++count;
        at = end;
    }
    if (count == 0) return false;
    if (count != 2)
        fail(ExitCode::invalid_input, "{}: got {} numbers (expected time and transmission)", where, count);
    out = {values[0], values[1]};
    return true;
}

}  // namespace

ShutterCurve ShutterCurve::box() {
    return points({{0, 1}, {1, 1}}, "box");
}

ShutterCurve ShutterCurve::triangle() {
    return points({{0, 0}, {0.5, 1}, {1, 0}}, "triangle");
}

ShutterCurve ShutterCurve::points(std::vector<std::pair<double, double>> points, const std::string& source) {
    if (points.size() < 2) {
        fail(ExitCode::invalid_input, "{}: too few points (got {}; expected 2 or more)", source,
             points.size());
    }
    const double begin = points.front().first, span = points.back().first - begin;
    double highest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto [time, transmission] = points[i];
        if (!std::isfinite(time) || (i > 0 && !(time > points[i - 1].first))) {
            fail(ExitCode::invalid_input, "{}: times do not grow (got {} at point {})", source, time, i + 1);
        }
        if (!(transmission >= 0) || !std::isfinite(transmission)) {
            fail(ExitCode::invalid_input,
                 "{}: transmission out of range (got {} at point {}; expected 0 or more)", source,
                 transmission, i + 1);
        }
        highest = std::max(highest, transmission);
    }
    if (!(highest > 0) || !std::isfinite(span)) {
        fail(ExitCode::invalid_input, "{}: the shutter never opens (expected a transmission above 0)",
             source);
    }
    ShutterCurve out;
    double light = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Knot k{(points[i].first - begin) / span, points[i].second / highest, 0};
        if (i > 0) {
            const Knot& before = out.knots_.back();
            light += 0.5 * (before.density + k.density) * (k.time - before.time);
        }
        k.light = light;
        out.knots_.push_back(k);
    }
    for (Knot& k : out.knots_) {
        k.density /= light;
        k.light /= light;
    }
    return out;
}

ShutterCurve ShutterCurve::read(const std::filesystem::path& path) {
    if (!std::filesystem::is_regular_file(path)) {
        fail(ExitCode::invalid_input, "{}: cannot read (expected a file of shutter transmissions)",
             path.string());
    }
    std::ifstream file(path);
    if (!file) fail(ExitCode::invalid_input, "{}: cannot read", path.string());
    std::vector<std::pair<double, double>> points;
    std::string line;
    for (std::size_t number = 1; std::getline(file, line); ++number) {
        std::pair<double, double> point;
        const std::string_view content = number == 1 ? without_byte_order_mark(line) : line;
        if (!parse_line(content, fmt::format("{}:{}", path.string(), number), point)) continue;
        points.push_back(point);
        if (points.size() > most_points) {
            fail(ExitCode::invalid_input, "{}:{}: too many points (expected at most {})", path.string(),
                 number, most_points);
        }
    }
    if (file.bad()) fail(ExitCode::invalid_input, "{}: cannot read", path.string());
    return ShutterCurve::points(std::move(points), path.string());
}

double ShutterCurve::time(double u) const {
    const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, u,
                                        [](double light, const Knot& k) { return light < k.light; });
    const Knot &a = *(after - 1), &b = *after;
    // Finds the time x after the curve's point `a`, in which the fraction `missing` of the exposure's light
    // passes the shutter. From `a` to the next point, `b`, the transmittance (density) changes linearly
    // during the time `width`. Therefore, x is the solution of
    //
    //     a.density x + (b.density - a.density) x^2 / (2 width) = missing
    const double width = b.time - a.time, missing = std::max(0.0, u - a.light);
    const double slope = (b.density - a.density) / width;
    const double root = std::sqrt(std::max(0.0, a.density * a.density + 2 * slope * missing));
    const double x = missing > 0 ? 2 * missing / (a.density + root) : 0;
    return std::min(a.time + std::min(x, width), 1.0);
}

double ShutterCurve::light(double time) const {
    if (!(time > 0)) return 0;
    if (time >= 1) return 1;
    const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time,
                                        [](double t, const Knot& k) { return t < k.time; });
    const Knot &a = *(after - 1), &b = *after;
    const double x = time - a.time, slope = (b.density - a.density) / (b.time - a.time);
    // Limiting the result to b.light keeps the curve monotonic despite rounding.
    return std::min(a.light + x * (a.density + 0.5 * slope * x), b.light);
}

std::uint64_t ShutterCurve::fingerprint() const {
    Fingerprint out;
    for (const Knot& k : knots_) {
        out.add(k.time);
        out.add(k.density);
    }
    return out.value();
}

double ShutterCurve::density(double time) const {
    if (!(time >= 0 && time <= 1)) return 0;
    const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time,
                                        [](double t, const Knot& k) { return t < k.time; });
    const Knot &a = *(after - 1), &b = *after;
    return a.density + (b.density - a.density) * (time - a.time) / (b.time - a.time);
}

}  // namespace postlens
