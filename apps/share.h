// Divides a command's work into shares for several machines: selects the share of each machine, and marks its
// result so that `merge` recognises it.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Parses a share I/N, with I from 0 to N - 1 and N from 1 to 100000. Throws Error(wrong_arguments) that
/// names the option.
[[nodiscard]] Share parse_share(std::string_view option, std::string_view text);

/// Whether the i-th of several items, such as frames, belongs to a share. A share has every N-th item, where
/// N is the number of shares.
[[nodiscard]] inline bool is_in(const Share& share, std::size_t i) {
    return i % static_cast<std::size_t>(share.count) == static_cast<std::size_t>(share.index);
}

/// The rows of a picture, or of a crop of it, that are a share; shares differ by at most one row. Throws
/// Error(wrong_arguments) if there are more shares than rows.
[[nodiscard]] Crop rows_of_share(const Share& share, const std::optional<Crop>& crop, int width, int height);

/// The options and input files of a command, as far as its result depends on them.
struct AskedFor {
    std::string command;
    std::vector<std::pair<std::string, std::vector<std::string>>> options;  ///< by name
    std::vector<std::pair<std::string, std::string>> inputs;                ///< option and file
    /// JSON with the version of postlens, the options, and the SHA-256 of the input files, whose paths do not
    /// count. Throws Error(invalid_input) for a file that cannot be read.
    [[nodiscard]] nlohmann::ordered_json fingerprint() const;
};

/// The mark of a part, from which `merge` recognises it: JSON with the share, the crop of the whole image,
/// and the fingerprint of the command.
[[nodiscard]] std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop);

/// Sets the share's rows as the crop of a command, and the mark of its part.
void take_share(std::optional<SharedWork>& work, std::optional<Crop>& crop, int width, int height);

/// Name of the first setting in which two fingerprints differ, with both values; empty if they are equal.
[[nodiscard]] std::string first_difference(const nlohmann::ordered_json& got,
                                           const nlohmann::ordered_json& expected);

}  // namespace postlens
