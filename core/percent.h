// Percent-encoding of texts (RFC 3986): any bytes as ASCII characters.
#pragma once

#include <string>

namespace postlens {

/// Writes % and all bytes above 0x7F as %XX, with two hexadecimal digits.
[[nodiscard]] std::string percent_encoded(const std::string& text);
/// Replaces each %XX by its byte. A % without two hexadecimal digits stays.
[[nodiscard]] std::string percent_decoded(const std::string& text);

}  // namespace postlens
