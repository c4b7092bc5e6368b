// Divides the work of a command between several machines, each of which computes one share. The result file
// of a share contains a description (mark), by which `merge` recognises the share.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/command.h"

namespace postlens {

inline constexpr int most_shares = 100000;
/// Whether there is a share `index` of `count`.
[[nodiscard]] constexpr bool is_share(std::int64_t index, std::int64_t count) {
    return index >= 0 && index < count && count <= most_shares;
}

/// Parses a share I/N, where I is from 0 to N - 1 and N is from 1 to 100000. Throws Error(wrong_arguments),
/// which names the option.
[[nodiscard]] Share parse_share(std::string_view option, std::string_view text);

/// Returns the rows that form a share of an image, or of a crop of the image. The numbers of rows in two
/// shares differ by at most one. Throws Error(wrong_arguments) if there are more shares than rows.
[[nodiscard]] Crop rows_of_share(const Share& share, const std::optional<Crop>& crop, int width, int height);

/// The options and input files that determine the result of a command.
struct AskedFor {
    std::string command;
    std::vector<std::pair<std::string, std::vector<std::string>>> options;  ///< by name
    struct Input {
        std::string option;
        std::string before, after;  ///< the option's value before and after the path
        std::string path;
        bool numbered =
            false;  ///< with --frames, `path` may contain a placeholder for the frame number (FrameName)
        bool hashes = false;  ///< `#` in `path` is a placeholder as well
        bool scene = false;   ///< `path` is a scene; the files that it refers to are inputs as well
    };
    std::vector<Input> inputs;
    /// Returns JSON that identifies the result: the version of postlens, the options, and the SHA-256 of each
    /// input file. `file_of` returns the path of an input. Throws Error(invalid_input) if an input cannot be
    /// read.
    [[nodiscard]] nlohmann::ordered_json fingerprint(
        const std::function<std::string(const Input&)>& file_of = {}) const;
};

/// Stores the digest of a scene that the command has read, so that AskedFor::fingerprint need not read the
/// scene again.
void remember_digest(const std::string& path, const Scene& scene);

/// Returns the mark that is stored in the result file of a share, so that `merge` recognises the share. The
/// mark is JSON with the share, the crop of the whole image, and the fingerprint of the command.
[[nodiscard]] std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop);

/// Returns the share of the work that a mark describes. A mark is the JSON in the result file of one machine.
/// Returns an empty value if the text is no such JSON.
[[nodiscard]] std::optional<Share> share_of_mark(const std::string& mark);

/// Returns the mark, i.e. the JSON description, of a result that is a set of items, such as the images of a
/// sweep. To join the results, `merge` runs the command again with the arguments `words`.
[[nodiscard]] std::string mark_of_items(const Share& share, const AskedFor& asked,
                                        const std::vector<std::string>& words);
/// Returns these arguments. The result is empty if `mark` holds none, or if they are damaged. JSON holds only
/// UTF-8, but names of files may be any bytes. In a mark, bytes that are not ASCII are therefore written as
/// %XX, and so is %.
[[nodiscard]] std::vector<std::string> words_of_mark(const nlohmann::ordered_json& mark);

/// Limits `crop` to the rows of the share, and sets work->mark to the text by which `merge` recognises the
/// result of the share. Does nothing if `work` is empty.
void take_share(std::optional<SharedWork>& work, std::optional<Crop>& crop, int width, int height);

/// Returns the first setting in which two fingerprints differ, as its name and both values. Returns an empty
/// text if the fingerprints are equal.
[[nodiscard]] std::string first_difference(const nlohmann::ordered_json& got,
                                           const nlohmann::ordered_json& expected);

}  // namespace postlens
