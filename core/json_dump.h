// Converts JSON to text. Its strings may contain any bytes, such as the names of files.
#pragma once

#include <string>

namespace postlens {

/// Returns the text of an nlohmann::json or ordered_json. Bytes that are not UTF-8 are replaced by U+FFFD. If
/// `indent` is negative, the text is one line.
template <class Json>
[[nodiscard]] std::string json_dump(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace postlens
