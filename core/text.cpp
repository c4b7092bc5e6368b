#include "core/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <system_error>
#include <vector>

namespace postlens {
namespace {

// Edit distance that counts a swap of two neighbouring letters as one edit (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::array<std::vector<std::size_t>, 3> rows;
    for (auto& row : rows) row.resize(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        auto& row = rows[i % 3];
        const auto& above = rows[(i + 2) % 3];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] =
                std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], rows[(i + 1) % 3][j - 2] + 1);
            }
        }
    }
    return rows[a.size() % 3][b.size()];
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
    if (text.starts_with('+')) {
        text.remove_prefix(1);
        if (text.starts_with('-') || text.starts_with('+')) return std::nullopt;
    }
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::invalid_argument || end != text.data() + text.size()) return std::nullopt;
    if (error == std::errc::result_out_of_range) {
        // from_chars reports underflow and overflow by the same error, and leaves `value` unchanged. A
        // negative exponent means underflow.
        const std::size_t e = text.find_first_of("eE");
        const bool tiny = e != std::string_view::npos && text.substr(e + 1).starts_with('-');
        return tiny ? 0.0 : std::numeric_limits<double>::infinity();
    }
    return value;
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t longest = 40;
    std::string out = "'";
    for (const char c : text.substr(0, longest)) {
        const auto byte = static_cast<unsigned char>(c);
        out += byte < 0x20 || byte >= 0x7F ? '?' : c;
    }
    if (text.size() > longest) out += "...";
    return out + "'";
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
}

std::string reason_of(std::string message) {
    while (!message.empty() && std::isspace(static_cast<unsigned char>(message.back())) != 0)
        message.pop_back();
    std::replace(message.begin(), message.end(), '\n', ' ');
    return message.empty() ? "no reason given" : message;
}

std::string printable_lines(std::string text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    for (std::size_t i = 0; i < text.size(); ++i) {
        // The control characters U+0080 to U+009F are two bytes in UTF-8.
        if (byte(i) == 0xC2 && i + 1 < text.size() && byte(i + 1) >= 0x80 && byte(i + 1) < 0xA0)
            text.replace(i, 2, 1, '?');
        if ((byte(i) < 0x20 && text[i] != '\n') || byte(i) == 0x7F) text[i] = '?';
    }
    return text;
}

std::string printable(std::string text) {
    text = printable_lines(std::move(text));
    std::replace(text.begin(), text.end(), '\n', '?');
    return text;
}

std::string rough(double value) {
    if (std::abs(value) >= 99.5) return fmt::format("{:.0f}", value);
    if (std::abs(value) < 1e-3) return fmt::format("{:.3f}", value);
    return fmt::format("{:.2g}", value);
}

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> candidates,
                              std::size_t most_edits) {
    std::string_view best;
    std::size_t best_distance = std::numeric_limits<std::size_t>::max();
    for (const std::string_view candidate : candidates) {
        // Compares only the first 256 characters, so that malicious input cannot take much time.
        const std::size_t distance = edit_distance(word.substr(0, 256), candidate.substr(0, 256));
        if (distance < best_distance && distance <= most_edits) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

}  // namespace postlens
