#include "apps/numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace postlens {
namespace {

template <typename Number>
std::optional<Number> parsed(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

template <typename Number>
std::optional<std::pair<Number, Number>> parsed_pair(std::string_view text, std::string_view separators) {
    const std::size_t at = text.find_first_of(separators);
    if (at == std::string_view::npos) return std::nullopt;
    const auto a = parsed<Number>(text.substr(0, at)), b = parsed<Number>(text.substr(at + 1));
    if (!a || !b) return std::nullopt;
    return std::pair{*a, *b};
}

}  // namespace

std::string OptionRange::text() const {
    if (std::isfinite(high)) return fmt::format("{:g} to {:.9g}", low, high);
    if (!std::isfinite(low)) return "";
    return includes_low ? fmt::format("{:g} or more", low) : fmt::format("more than {:g}", low);
}

void check_bounds(std::string_view option, double value, std::string_view text, const OptionRange& bounds) {
    if (bounds.hold(value)) return;
    fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected {})", option, text, bounds.text());
}

double parse_number(std::string_view option, std::string_view text, bool infinite) {
    const auto value = parsed<double>(text);
    if (value && (std::isfinite(*value) || (infinite && *value == std::numeric_limits<double>::infinity())))
        return *value;
    fail(ExitCode::wrong_arguments, "{}: not a number (got {}; expected {})", option,
         text.empty() ? "nothing" : text, infinite ? "a number or inf" : "a finite number");
}

int parse_whole(std::string_view option, std::string_view text, const OptionRange& bounds) {
    if (const auto value = parsed<int>(text)) return *value;
    const std::string_view digits = text.substr(text.starts_with('-') || text.starts_with('+') ? 1 : 0);
    if (!digits.empty() && digits.find_first_not_of("0123456789") == std::string_view::npos) {
        using Limits = std::numeric_limits<int>;
        fail(ExitCode::wrong_arguments, "{}: too {} (got {}; expected {:.0f} to {:.0f})", option,
             text.starts_with('-') ? "small" : "large", text, std::max<double>(bounds.low, Limits::min()),
             std::min<double>(bounds.high, Limits::max()));
    }
    fail(ExitCode::wrong_arguments, "{}: not a whole number (got {}; expected e.g. 4)", option,
         text.empty() ? "nothing" : text);
}

std::pair<int, int> parse_size(std::string_view option, std::string_view text) {
    if (const auto size = parsed_pair<int>(text, "xX")) return *size;
    fail(ExitCode::wrong_arguments, "{}: not a size (got {}; expected WxH, e.g. 960x540)", option, text);
}

std::pair<double, double> parse_position(std::string_view option, std::string_view text) {
    const auto p = parsed_pair<double>(text, ",");
    if (p && std::isfinite(p->first) && std::isfinite(p->second)) return *p;
    fail(ExitCode::wrong_arguments, "{}: not a position (got {}; expected X,Y in pixels, e.g. 480,270)",
         option, text);
}

std::pair<double, double> parse_span(std::string_view option, std::string_view text) {
    const auto span = parsed_pair<double>(text, ":");
    if (span && std::isfinite(span->first) && std::isfinite(span->second)) return *span;
    fail(ExitCode::wrong_arguments,
         "{}: not two instants (got {}; expected OPEN:CLOSE in seconds, e.g. 0:0.02)", option, text);
}

std::uint64_t parse_seed(std::string_view option, std::string_view text) {
    if (const auto value = parsed<std::uint64_t>(text)) return *value;
    fail(ExitCode::wrong_arguments, "{}: not a seed (got {}; expected a whole number from 0 to 2^64 - 1)",
         option, text.empty() ? "nothing" : text);
}

std::pair<double, double> parse_scale(std::string_view option, std::string_view text) {
    const auto one = parsed<double>(text);
    const auto two = one ? std::pair{*one, *one} : parsed_pair<double>(text, ",");
    if (two && std::isfinite(two->first) && std::isfinite(two->second)) return *two;
    fail(ExitCode::wrong_arguments, "{}: not one or two numbers (got {}; expected X or X,Y, e.g. 1,-1)",
         option, text);
}

DepthEncoding parse_depth_encoding(std::string_view option, std::string_view text) {
    if (text == "distance") return {};
    if (text == "inverse") return {.kind = DepthEncoding::Kind::inverse};
    constexpr std::string_view planes = "normalized:";
    if (text.starts_with(planes)) {
        const auto at = parsed_pair<double>(text.substr(planes.size()), ",");
        if (at && std::isfinite(at->first) && std::isfinite(at->second) && at->first >= 0 &&
            at->second >= 0 && at->first != at->second)
            return {.kind = DepthEncoding::Kind::normalized, .at_0 = at->first, .at_1 = at->second};
    }
    fail(ExitCode::wrong_arguments,
         "{}: unknown (got {}; expected distance, inverse or normalized:NEAR,FAR, two different distances of "
         "0 or more)",
         option, text);
}

std::pair<std::string, std::string> parse_names(std::string_view option, std::string_view text) {
    const std::size_t comma = text.find(',');
    if (comma != std::string_view::npos && comma > 0 && comma + 1 < text.size() &&
        text.find(',', comma + 1) == std::string_view::npos)
        return {std::string(text.substr(0, comma)), std::string(text.substr(comma + 1))};
    fail(ExitCode::wrong_arguments, "{}: not two names (got {}; expected U,V, e.g. forward.u,forward.v)",
         option, text.empty() ? "nothing" : text);
}

std::vector<int> parse_whole_list(std::string_view option, std::string_view text) {
    constexpr std::size_t most = 1000;
    std::vector<int> out;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        out.push_back(parse_whole(option, text.substr(begin, end - begin)));
        if (out.size() > most)
            fail(ExitCode::wrong_arguments, "{}: too many (got more than {}; expected fewer)", option, most);
        begin = end + 1;
    }
    return out;
}

std::string px_text(double px) {
    return std::abs(px) < 1e7 ? fmt::format("{:.1f} px", px) : fmt::format("{:.3g} px", px);
}

Crop parse_crop(std::string_view option, std::string_view text) {
    std::vector<int> values;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const auto value = parsed<int>(text.substr(begin, end - begin));
        if (!value || values.size() == 4) {
            values.clear();
            break;
        }
        values.push_back(*value);
        begin = end + 1;
    }
    if (values.size() == 4 && values[0] >= 0 && values[1] >= 0 && values[2] > 0 && values[3] > 0)
        return {values[0], values[1], values[2], values[3]};
    fail(ExitCode::wrong_arguments,
         "{}: not a part of a picture (got {}; expected X,Y,W,H in whole pixels, W and H 1 or more, e.g. "
         "480,270,64,64)",
         option, text.empty() ? "nothing" : text);
}

double in_range(std::string_view option, double value, double low, bool including_low, const char* expected) {
    if (value > low || (including_low && value == low)) return value;
    fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected {})", option, value, expected);
}

}  // namespace postlens
