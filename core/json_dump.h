// Converts JSON to text. Its strings may contain any bytes, because they may be file names.
#pragma once

#include <string>

namespace postlens {

/// Returns the text of an nlohmann::json or ordered_json. Bytes that are not UTF-8 become U+FFFD. A negative
/// `indent` gives one line.
template <class Json>
[[nodiscard]] std::string json_dump(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace postlens
