#include "sweep/values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/text.h"

namespace postlens {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> out;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        out.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return out;
}

double length_of(const std::string& option, std::string_view text, bool infinite) {
    if (infinite && text == "inf") return std::numeric_limits<double>::infinity();
    const std::optional<double> value = parse_number(text);
    if (!value || !std::isfinite(*value)) {
        fail(ExitCode::wrong_arguments, "{}: not a number (got {}; expected {})", option,
             text.empty() ? "nothing" : text, infinite ? "a number or inf" : "a finite number");
    }
    if (!(*value > 0))
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected more than 0)", option, text);
    return *value;
}

void check_count(const std::string& option, std::string_view text, double count) {
    if (count <= static_cast<double>(most_pictures)) return;
    fail(ExitCode::wrong_arguments,
         "{}: range of too many values (got {}, {:.0f} values; expected {} at most)", option, text, count,
         most_pictures);
}

/// Parses a number such as "0.5" or a fraction such as "1/2".
std::optional<double> fraction(std::string_view text) {
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos) return parse_number(text);
    const auto above = parse_number(text.substr(0, slash)), below = parse_number(text.substr(slash + 1));
    if (!above || !below || *below == 0) return std::nullopt;
    return *above / *below;
}

void add_stops(const std::string& option, std::string_view text, std::vector<double>& out) {
    const std::vector<std::string_view> parts = split(text, ':');
    if (parts.size() != 3) {
        fail(ExitCode::wrong_arguments,
             "{}: not a range (got {}; expected FROM:TO:STEP, STEP in stops, e.g. 1.4:16:1/2)", option, text);
    }
    const double from = length_of(option, parts[0], false), to = length_of(option, parts[1], false);
    const std::optional<double> step = fraction(parts[2]);
    if (!step || !(*step > 0) || !std::isfinite(*step)) {
        fail(ExitCode::wrong_arguments, "{}: step out of range (got {}; expected stops, more than 0)", option,
             parts[2].empty() ? "nothing" : parts[2]);
    }
    if (from > to) {
        fail(ExitCode::wrong_arguments, "{}: range runs backwards (got {}; expected FROM not above TO)",
             option, text);
    }
    // The f-numbers engraved on a lens are rounded. For example, f/11 stands for f/11.31, which is 0.08 stops
    // more. A range that ends at 11 must include it. Therefore, the last value may exceed the given end by
    // this many stops.
    constexpr double missed_stops = 0.1;
    const double stops = 2 * std::log2(to / from);
    const double steps = std::floor((stops + std::min(missed_stops, *step / 2)) / *step);
    check_count(option, text, steps + 1);
    for (int i = 0; i <= static_cast<int>(steps); ++i) out.push_back(from * std::exp2(i * *step / 2));
}

/// Parses a range FROM:TO:COUNT, whose values are evenly spaced in scale(value).
template <typename Scale, typename Value>
void add_even(const std::string& option, std::string_view text, bool infinite, const Scale& scale,
              const Value& value, std::vector<double>& out) {
    const std::vector<std::string_view> parts = split(text, ':');
    const std::optional<double> count = parts.size() == 3 ? parse_number(parts[2]) : std::nullopt;
    if (!count || *count != std::floor(*count)) {
        fail(ExitCode::wrong_arguments, "{}: not a range (got {}; expected FROM:TO:COUNT, e.g. 2:8:24)",
             option, text);
    }
    const double from = length_of(option, parts[0], infinite), to = length_of(option, parts[1], infinite);
    if (!(*count >= 2) || from == to) {
        fail(ExitCode::wrong_arguments,
             "{}: empty range (got {}; expected two different ends and a COUNT of 2 or more)", option, text);
    }
    check_count(option, text, *count);
    const int last = static_cast<int>(*count) - 1;
    for (int i = 0; i <= last; ++i) {
        const double u = static_cast<double>(i) / last;
        out.push_back(i == 0 ? from : i == last ? to : value((1 - u) * scale(from) + u * scale(to)));
    }
}

template <typename AddRange>
std::vector<double> list(const std::string& option, std::string_view text, bool infinite,
                         const AddRange& add_range) {
    std::vector<double> out;
    for (const std::string_view item : split(text, ',')) {
        if (item.find(':') == std::string_view::npos) {
            out.push_back(length_of(option, item, infinite));
        } else {
            add_range(item, out);
        }
    }
    check_count(option, text, static_cast<double>(out.size()));
    std::vector<double> sorted = out;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end()) {
        fail(ExitCode::wrong_arguments, "{}: twice in the list (got {:.6g}; expected every value once)",
             option, *twice);
    }
    return out;
}

bool begins_impulse(std::string_view text) {
    constexpr std::array<std::string_view, 5> kinds{"disc", "polygon", "diffraction", "image", "lens"};
    return std::any_of(kinds.begin(), kinds.end(),
                       [text](std::string_view kind) { return text.starts_with(kind); });
}

}  // namespace

std::vector<double> f_number_list(const std::string& option, std::string_view text) {
    return list(option, text, true,
                [&](std::string_view item, std::vector<double>& out) { add_stops(option, item, out); });
}

std::vector<double> focus_list(const std::string& option, std::string_view text) {
    const auto inverse = [](double v) { return 1 / v; };
    return list(option, text, true, [&](std::string_view item, std::vector<double>& out) {
        add_even(option, item, true, inverse, inverse, out);
    });
}

std::vector<double> focal_length_list(const std::string& option, std::string_view text) {
    return list(option, text, false, [&](std::string_view item, std::vector<double>& out) {
        add_even(
            option, item, false, [](double v) { return std::log(v); }, [](double v) { return std::exp(v); },
            out);
    });
}

std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text) {
    std::vector<TimeSpan> out;
    for (const std::string_view item : split(text, ',')) {
        const std::vector<std::string_view> parts = split(item, ':');
        const auto open = parse_number(parts[0]),
                   close = parts.size() == 2 ? parse_number(parts[1]) : std::nullopt;
        if (!open || !close || !std::isfinite(*close - *open)) {
            fail(ExitCode::wrong_arguments,
                 "{}: not two instants (got {}; expected OPEN:CLOSE in seconds, e.g. 0:0.02)", option,
                 item.empty() ? "nothing" : item);
        }
        if (*open > *close) {
            fail(ExitCode::wrong_arguments,
                 "{}: closes before it opens (got {}; expected OPEN not after CLOSE)", option, item);
        }
        const bool twice = std::any_of(out.begin(), out.end(), [&](const TimeSpan& s) {
            return s.open_s == *open && s.close_s == *close;
        });
        if (twice) {
            fail(ExitCode::wrong_arguments, "{}: twice in the list (got {}; expected every value once)",
                 option, item);
        }
        out.push_back(TimeSpan{*open, *close});
    }
    return out;
}

std::vector<Impulse> impulse_list(const std::string& option, std::string_view text) {
    std::vector<std::string> items;
    for (const std::string_view part : split(text, ',')) {
        if (items.empty() || begins_impulse(part)) {
            items.emplace_back(part);
        } else {
            items.back().append(",").append(part);
        }
    }
    std::vector<Impulse> out;
    for (auto item = items.begin(); item != items.end(); ++item) {
        if (std::find(items.begin(), item, *item) != item) {
            fail(ExitCode::wrong_arguments, "{}: twice in the list (got {}; expected every value once)",
                 option, *item);
        }
        out.push_back(parse_impulse(option, *item));
    }
    return out;
}

}  // namespace postlens
