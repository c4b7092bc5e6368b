// Handles names of channels as text: separates layer and last word, and converts to lower case.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

using ChannelNames = std::vector<std::string>;

/// Returns the first of the names that the part has as a channel; empty if it has none of them.
[[nodiscard]] std::string first_channel(const ForeignPart& part, const ChannelNames& names);

/// Splits a name after its last dot.
[[nodiscard]] std::pair<std::string, std::string> split_channel(const std::string& name);

/// Whether one of `some` is among the words.
[[nodiscard]] bool has_any_word(const std::vector<std::string>& words,
                                std::initializer_list<std::string_view> some);

}  // namespace postlens
