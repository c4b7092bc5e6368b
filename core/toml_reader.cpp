#include "core/toml_reader.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace postlens {
namespace {

std::string place_of(const std::string& file, const toml::source_position& at) {
    // toml++ gives no position for a table that is defined only implicitly. Error messages then name line 1.
    return at.line == 0 ? fmt::format("{}:1:1", file) : fmt::format("{}:{}:{}", file, at.line, at.column);
}

std::string_view article_and_type(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table:
            return "a table";
        case toml::node_type::array:
            return "an array";
        case toml::node_type::string:
            return "a text";
        case toml::node_type::integer:
        case toml::node_type::floating_point:
            return "a number";
        case toml::node_type::boolean:
            return "true or false";
        default:
            return "a date or time";
    }
}

std::string shown(const toml::node& node) {
    if (const auto* s = node.as_string()) return excerpt(s->get());
    if (const auto* i = node.as_integer()) return fmt::format("{}", i->get());
    if (const auto* f = node.as_floating_point()) return fmt::format("{}", f->get());
    if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
    if (const auto* a = node.as_array()) return fmt::format("an array of {}", a->size());
    return std::string(article_and_type(node));
}

std::string range_text(const NumberRange& range) {
    const bool below = range.min > -std::numeric_limits<double>::max();
    const bool above = range.max < std::numeric_limits<double>::max();
    std::string text = "a finite number";
    if (below && above) {
        text = fmt::format("{}{:g} to {:g}", range.excludes_min ? "more than " : "", range.min, range.max);
    } else if (below) {
        text = fmt::format("{} {:g}", range.excludes_min ? "more than" : "at least", range.min);
    } else if (above) {
        text = fmt::format("at most {:g}", range.max);
    }
    return range.may_be_infinite ? text + " or inf" : text;
}

/// Refuses keys with very many parts, such as a.a.a.a. The parser visits their nested tables recursively,
/// which could overflow the stack. Its own depth limit covers only arrays and inline tables.
void check_depth_of_keys(std::string_view text, const std::string& file) {
    constexpr int most_parts = 256;
    const auto past = [&](std::size_t at) {
        const char quote = text[at];
        const std::string three(3, quote);
        const bool is_long = text.substr(at, 3) == three;
        for (std::size_t i = at + (is_long ? 3 : 1); i < text.size(); ++i) {
            if (quote == '"' && text[i] == '\\') {
                ++i;
            } else if (is_long ? text.substr(i, 3) == three : text[i] == quote || text[i] == '\n') {
                return i + (is_long ? 3 : 1);
            }
        }
        return text.size();
    };
    int dots = 0, line = 1;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (c == '"' || c == '\'') {
            const std::size_t end = std::min(past(i), text.size());
            line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                                text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
            i = end;
            continue;
        }
        if (c == '#') {
            i = std::min(text.find('\n', i), text.size());
            continue;
        }
        if (c == '.' && ++dots == most_parts) {
            fail(ExitCode::invalid_input,
                 "{}:{}: not valid TOML: a key of too many parts (expected at most {})", file, line,
                 most_parts);
        }
        if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) dots = 0;
        line += c == '\n' ? 1 : 0;
        ++i;
    }
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& file) {
    check_depth_of_keys(text, file);
    try {
        return toml::parse(text, file);
    } catch (const toml::parse_error& error) {
        const auto& at = error.source().begin;
        // The error message of the parser, on one line.
        std::string words(error.description());
        for (char& c : words) {
            const auto byte = static_cast<unsigned char>(c);
            if (byte < 0x20 || byte >= 0x7F) c = '?';
        }
        fail(ExitCode::invalid_input, "{}:{}:{}: not valid TOML: {}", file, at.line, at.column, words);
    }
}

void TomlTable::fail_at_node(const toml::node& node, const std::string& text) const {
    fail(ExitCode::invalid_input, "{}: {}: {}", place_of(*file_, node.source().begin), what_, text);
}

std::string TomlTable::place(std::string_view key) const {
    return place_of(*file_, table_->get(key)->source().begin);
}

std::string TomlTable::line() const {
    return fmt::format("{}:{}", *file_, std::max<toml::source_index>(table_->source().begin.line, 1));
}

void TomlTable::allow_only(std::initializer_list<std::span<const std::string_view>> known) const {
    std::vector<std::string_view> all;
    for (const auto& list : known) all.insert(all.end(), list.begin(), list.end());
    const toml::key* first = nullptr;
    for (const auto& [key, value] : *table_) {
        if (std::find(all.begin(), all.end(), key.str()) != all.end()) continue;
        // Finds the unknown key that comes first in the file, for the error message. toml++ sorts keys by
        // name.
        if (first == nullptr || key.source().begin < first->source().begin) first = &key;
    }
    if (first == nullptr) return;
    fail(ExitCode::invalid_input, "{}: {}: unknown key (got {}; nearest known key: '{}')",
         place_of(*file_, first->source().begin), what_, excerpt(first->str()),
         nearest_word(first->str(), all));
}

double TomlTable::number_of(const toml::node& node, std::string_view key, const NumberRange& range) const {
    std::optional<double> value;
    if (const auto* whole = node.as_integer()) value = static_cast<double>(whole->get());
    if (const auto* real = node.as_floating_point()) value = real->get();
    if (!value) {
        fail_at_node(node, fmt::format("'{}' is {} (got {}; expected a number)", key, article_and_type(node),
                                       shown(node)));
    }
    const double v = *value;
    const bool infinite = v == std::numeric_limits<double>::infinity();
    const bool fits = (v >= range.min && v <= range.max && !(range.excludes_min && v == range.min)) ||
                      (infinite && range.may_be_infinite);
    if (!fits) {
        fail_at_node(node,
                     fmt::format("'{}' is out of range (got {}; expected {})", key, v, range_text(range)));
    }
    return v;
}

std::string TomlTable::text_of(const toml::node& node, std::string_view key) const {
    const auto* value = node.as_string();
    if (value == nullptr) {
        fail_at_node(node, fmt::format("'{}' is {} (got {}; expected a text)", key, article_and_type(node),
                                       shown(node)));
    }
    const std::string& text = value->get();
    constexpr std::size_t longest = 255;
    const bool printable = std::none_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7F;
    });
    if (text.empty() || text.size() > longest || !printable) {
        fail_at_node(node,
                     fmt::format("'{}' is not a usable text (got {}; expected 1 to {} printable characters)",
                                 key, shown(node), longest));
    }
    return text;
}

const toml::array& TomlTable::array_of(const toml::node& node, std::string_view key,
                                       std::string_view of) const {
    if (const auto* array = node.as_array()) return *array;
    fail_at_node(node, fmt::format("'{}' is {} (got {}; expected an array of {})", key,
                                   article_and_type(node), shown(node), of));
}

std::vector<double> TomlTable::numbers_of(const toml::node& node, std::string_view key, std::size_t count,
                                          const NumberRange& range) const {
    const toml::array& array = array_of(node, key, fmt::format("{} numbers", count));
    if (array.size() != count) {
        fail_at_node(node, fmt::format("'{}' has the wrong length (got {}; expected {} numbers)", key,
                                       array.size(), count));
    }
    std::vector<double> out;
    for (const toml::node& element : array) out.push_back(number_of(element, key, range));
    return out;
}

std::optional<double> TomlTable::number(std::string_view key, const NumberRange& range) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    return number_of(*node, key, range);
}

std::optional<int> TomlTable::integer(std::string_view key, int min, int max) const {
    const std::optional<double> value =
        number(key, {.min = static_cast<double>(min), .max = static_cast<double>(max)});
    if (!value) return std::nullopt;
    if (*value != std::floor(*value))
        fail_at(key, "'{}' is not whole (got {}; expected a whole number)", key, *value);
    return static_cast<int>(*value);
}

std::optional<bool> TomlTable::flag(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* value = node->as_boolean()) return value->get();
    fail_at_node(*node, fmt::format("'{}' is {} (got {}; expected true or false)", key,
                                    article_and_type(*node), shown(*node)));
}

std::optional<std::string> TomlTable::text(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    return text_of(*node, key);
}

std::optional<std::size_t> TomlTable::choice(std::string_view key,
                                             std::span<const std::string_view> choices) const {
    const std::optional<std::string> value = text(key);
    if (!value) return std::nullopt;
    const auto at = std::find(choices.begin(), choices.end(), *value);
    if (at == choices.end()) {
        fail_at(key, "'{}' is unknown (got {}; nearest known: '{}'; expected one of {})", key,
                excerpt(*value), nearest_word(*value, choices), fmt::join(choices, ", "));
    }
    return static_cast<std::size_t>(at - choices.begin());
}

std::optional<glm::dvec3> TomlTable::vec3(std::string_view key, const NumberRange& range) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    const auto v = numbers_of(*node, key, 3, range);
    return glm::dvec3(v[0], v[1], v[2]);
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key, std::size_t count,
                                                      const NumberRange& range) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    return numbers_of(*node, key, count, range);
}

std::vector<double> TomlTable::number_list(std::string_view key, const NumberRange& range) const {
    std::vector<double> out;
    const toml::node* node = table_->get(key);
    if (node == nullptr) return out;
    for (const toml::node& element : array_of(*node, key, "numbers"))
        out.push_back(number_of(element, key, range));
    return out;
}

bool TomlTable::is_array(std::string_view key) const {
    const toml::node* node = table_->get(key);
    return node != nullptr && node->is_array();
}

std::optional<glm::dvec3> TomlTable::number_or_vec3(std::string_view key, const NumberRange& range) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_array() && !node->is_number()) {
        fail_at_node(*node, fmt::format("'{}' is {} (got {}; expected a number or 3 numbers)", key,
                                        article_and_type(*node), shown(*node)));
    }
    return node->is_array() ? vec3(key, range) : glm::dvec3(number_of(*node, key, range));
}

std::optional<std::vector<std::vector<double>>> TomlTable::rows(std::string_view key, std::size_t min_columns,
                                                                std::size_t max_columns,
                                                                const NumberRange& range) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    std::vector<std::vector<double>> out;
    for (const toml::node& row_node : array_of(*node, key, "arrays of numbers")) {
        const toml::array& row = array_of(row_node, key, "numbers");
        if (row.size() < min_columns || row.size() > max_columns) {
            fail_at_node(
                row_node,
                fmt::format("a row of '{}' has the wrong length (got {}; expected {})", key, row.size(),
                            min_columns == max_columns ? fmt::format("{}", min_columns)
                                                       : fmt::format("{} to {}", min_columns, max_columns)));
        }
        auto& numbers = out.emplace_back();
        numbers.reserve(row.size());
        for (const toml::node& element : row) numbers.push_back(number_of(element, key, range));
    }
    return out;
}

std::optional<std::vector<std::string>> TomlTable::texts(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    if (node->is_string()) return std::vector{text_of(*node, key)};
    std::vector<std::string> out;
    for (const toml::node& element : array_of(*node, key, "texts")) out.push_back(text_of(element, key));
    return out;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    if (const toml::table* t = node->as_table())
        return TomlTable(*file_, *t, fmt::format("{}: {}", what_, key));
    fail_at_node(*node, fmt::format("'{}' is {} (got {}; expected a table)", key, article_and_type(*node),
                                    shown(*node)));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key, std::string_view what) const {
    std::vector<TomlTable> out;
    const toml::node* node = table_->get(key);
    if (node == nullptr) return out;
    for (const toml::node& element : array_of(*node, key, "tables")) {
        const toml::table* t = element.as_table();
        if (t == nullptr) {
            fail_at_node(element, fmt::format("'{}' holds {} (got {}; expected tables)", key,
                                              article_and_type(element), shown(element)));
        }
        out.emplace_back(*file_, *t, fmt::format("{} {}", what, out.size() + 1));
    }
    return out;
}

void TomlTable::refuse_both(std::string_view a, std::string_view b) const {
    if (has(a) && has(b)) fail_at(b, "'{}' and '{}' cannot stand together (expected one of them)", a, b);
}

}  // namespace postlens
