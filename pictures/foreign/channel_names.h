// Splits a channel name such as "left.depth.Z" into its layer "left.depth." and its component "Z". Also
// searches for channels by name, and for words in a name.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

using ChannelNames = std::vector<std::string>;

/// Returns the first of `names` that is a channel of the part, or an empty text.
[[nodiscard]] std::string first_channel(const ForeignPart& part, const ChannelNames& names);

/// Splits a name after its last dot: "left.depth.Z" becomes "left.depth." and "Z".
[[nodiscard]] std::pair<std::string, std::string> split_channel(const std::string& name);

/// Returns true if one of `some` is among the words.
[[nodiscard]] bool has_any_word(const std::vector<std::string>& words,
                                std::initializer_list<std::string_view> some);

}  // namespace postlens
