#include "scene/gltf/json_place.h"

#include <cmath>

#include "core/text.h"

namespace postlens {
namespace {

using nlohmann::json;

constexpr int deepest = 128;
constexpr std::size_t most_values = 4'000'000;

// Returns a short description of a value for error messages.
std::string shown(const json& value) {
    if (value.is_string()) return excerpt(value.get_ref<const std::string&>());
    if (value.is_number() || value.is_boolean()) return value.dump();
    return std::string("an ") + (value.is_array() ? "array" : value.is_object() ? "object" : "empty value");
}

// Returns the message of the parser without its error number, at most 200 printable ASCII characters.
std::string one_line(const json::exception& error) {
    std::string text = error.what();
    const auto end = text.find("] ");
    if (end != std::string::npos) text.erase(0, end + 2);
    for (char& c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte >= 0x7F) c = '?';
    }
    return text.substr(0, 200);
}

// Checks nesting depth and number of values by counting brackets, commas and colons outside strings.
// The parser's own callback is slow: after each element of an array, it scans the whole array again.
void check_extent(std::string_view text, const std::string& file) {
    int depth = 0;
    std::size_t values = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            in_string = c != '"';
            continue;
        }
        in_string = c == '"';
        const bool opens = c == '{' || c == '[';
        if (opens && ++depth > deepest) {
            fail(ExitCode::invalid_input, "{}: nests too deeply (expected at most {} levels)", file, deepest);
        }
        if (c == '}' || c == ']') --depth;
        if ((opens || c == ',' || c == ':') && ++values > most_values) {
            fail(ExitCode::invalid_input, "{}: has too many values (expected at most {})", file, most_values);
        }
    }
}

}  // namespace

json parse_json(std::string_view text, const std::string& file) {
    check_extent(text, file);
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::exception& error) {
        // The JSON parser also throws other exceptions, such as out_of_range for a number too large for a
        // double.
        fail(ExitCode::invalid_input, "{}: is no JSON ({})", file, one_line(error));
    }
}

const json* JsonPlace::find(const char* key) const {
    const auto at = value_->find(key);
    return at == value_->end() ? nullptr : &*at;
}

JsonPlace JsonPlace::below(const char* key, const json& value) const {
    return {*file_, value, where_.empty() ? std::string(key) : where_ + "." + key};
}

std::optional<JsonPlace> JsonPlace::object(const char* key) const {
    const json* found = find(key);
    if (!found) return std::nullopt;
    JsonPlace place = below(key, *found);
    if (!found->is_object()) place.fail_here("is no object (got {}; expected an object)", shown(*found));
    return place;
}

std::vector<JsonPlace> JsonPlace::objects(const char* key) const {
    std::vector<JsonPlace> out;
    const json* found = find(key);
    if (!found) return out;
    const JsonPlace list = below(key, *found);
    if (!found->is_array())
        list.fail_here("is no array (got {}; expected an array of objects)", shown(*found));
    out.reserve(found->size());
    for (const json& item : *found) {
        JsonPlace& place = out.emplace_back(*file_, item, fmt::format("{}[{}]", list.where(), out.size()));
        if (!item.is_object()) place.fail_here("is no object (got {}; expected an object)", shown(item));
    }
    return out;
}

std::optional<JsonPlace> JsonPlace::extension(const char* name) const {
    const auto extensions = object("extensions");
    return extensions ? extensions->object(name) : std::nullopt;
}

std::optional<double> JsonPlace::number(const char* key, double least, double most) const {
    const json* found = find(key);
    if (!found) return std::nullopt;
    const JsonPlace place = below(key, *found);
    if (!found->is_number()) place.fail_here("is no number (got {}; expected a number)", shown(*found));
    const auto value = found->get<double>();
    if (!(value >= least && value <= most)) {
        place.fail_here("is out of range (got {}; expected {} to {})", value, least, most);
    }
    return value;
}

std::optional<std::size_t> JsonPlace::whole(const char* key, std::size_t least, std::size_t most) const {
    const auto value = number(key, static_cast<double>(least), static_cast<double>(most));
    if (!value) return std::nullopt;
    if (*value != std::floor(*value)) {
        below(key, *find(key)).fail_here("is not whole (got {}; expected a whole number)", *value);
    }
    return static_cast<std::size_t>(*value);
}

std::size_t JsonPlace::as_index(const json& value, std::size_t count) const {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count) {
        fail_here("refers to nothing (got {}; expected an index below {})", shown(value), count);
    }
    return value.get<std::size_t>();
}

std::optional<std::size_t> JsonPlace::index(const char* key, std::size_t count) const {
    const json* found = find(key);
    if (!found) return std::nullopt;
    return below(key, *found).as_index(*found, count);
}

std::vector<std::size_t> JsonPlace::indices(const char* key, std::size_t count) const {
    std::vector<std::size_t> out;
    const json* found = find(key);
    if (!found) return out;
    const JsonPlace place = below(key, *found);
    if (!found->is_array()) place.fail_here("is no array (got {}; expected indices)", shown(*found));
    for (const json& item : *found) out.push_back(place.as_index(item, count));
    return out;
}

std::optional<std::vector<double>> JsonPlace::numbers(const char* key, std::size_t count, double least,
                                                      double most) const {
    const json* found = find(key);
    if (!found) return std::nullopt;
    const JsonPlace place = below(key, *found);
    if (!found->is_array() || found->size() != count) {
        place.fail_here("has the wrong length (expected {} numbers)", count);
    }
    std::vector<double> out;
    for (const json& item : *found) {
        if (!item.is_number()) place.fail_here("holds no number (got {}; expected numbers)", shown(item));
        out.push_back(item.get<double>());
        if (!(out.back() >= least && out.back() <= most)) {
            place.fail_here("is out of range (got {}; expected {} to {})", out.back(), least, most);
        }
    }
    return out;
}

std::optional<std::string> JsonPlace::text(const char* key) const {
    const json* found = find(key);
    if (!found) return std::nullopt;
    if (!found->is_string()) {
        below(key, *found).fail_here("is no text (got {}; expected text)", shown(*found));
    }
    return found->get<std::string>();
}

std::vector<std::string> JsonPlace::texts(const char* key) const {
    std::vector<std::string> out;
    const json* found = find(key);
    if (!found) return out;
    const JsonPlace place = below(key, *found);
    if (!found->is_array()) place.fail_here("is no array (got {}; expected texts)", shown(*found));
    for (const json& item : *found) {
        if (!item.is_string()) place.fail_here("holds no text (got {}; expected texts)", shown(item));
        out.push_back(item.get<std::string>());
    }
    return out;
}

bool JsonPlace::flag(const char* key, bool otherwise) const {
    const json* found = find(key);
    if (!found) return otherwise;
    if (!found->is_boolean()) below(key, *found).fail_here("is no truth value (got {})", shown(*found));
    return found->get<bool>();
}

}  // namespace postlens
