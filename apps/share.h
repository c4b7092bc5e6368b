// Divides the work of a command between several machines, each of which computes one share. `merge`
// recognises a share's file by its mark (JSON that describes share and command).
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

/// Parses a share I/N, where N is at most 100000 and I is from 0 to N - 1. Throws Error(wrong_arguments),
/// which names the option.
[[nodiscard]] Share parse_share(std::string_view option, std::string_view text);

/// Returns the rows that form a share of an image or crop. The numbers of rows of two shares differ by at
/// most one. Throws Error(wrong_arguments) if there are more shares than rows.
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
    /// input file. Throws Error(invalid_input) if a file cannot be read.
    [[nodiscard]] nlohmann::ordered_json fingerprint(
        const std::function<std::string(const Input&)>& file_of = {}) const;
};

/// Stores the hash of a scene that was already read. AskedFor::fingerprint, which contains the hash of each
/// input file of a command, then need not read the scene again.
void remember_digest(const std::string& path, const Scene& scene);

/// Returns JSON that is stored in a result file if several machines divide a command (--share). It contains
/// this machine's share, the crop of the whole image, and the command's fingerprint. By this mark, `merge`
/// recognises the file.
[[nodiscard]] std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop);

/// Returns the share of the work (I of N) whose result a file contains. `mark` is JSON from this file
/// (mark_of). Returns nothing if `mark` is invalid.
[[nodiscard]] std::optional<Share> share_of_mark(const std::string& mark);

/// Like mark_of, if several machines divide the images of a sweep or the points of a chart. The returned JSON
/// also contains the command-line arguments `words`. With these, `merge` runs the command again to join the
/// results.
[[nodiscard]] std::string mark_of_items(const Share& share, const AskedFor& asked,
                                        const std::vector<std::string>& words);
/// Returns the command-line arguments that mark_of_items stored in the JSON `mark`. Returns nothing if there
/// are none or they are damaged. In `mark`, % and bytes that are not ASCII are written as %XX, because JSON
/// must be UTF-8.
[[nodiscard]] std::vector<std::string> words_of_mark(const nlohmann::ordered_json& mark);

/// If several machines divide the rows of an image, sets `crop` to the rows of this machine. Also sets
/// `work->mark`, JSON by which `merge` later recognises this machine's result file. Does nothing if `work` is
/// empty, i.e. if the image is not divided.
void take_share(std::optional<SharedWork>& work, std::optional<Crop>& crop, int width, int height);

/// Compares the fingerprints (options and input files) of two commands. Returns the first difference, with
/// its name and both values, or an empty text if there is none.
[[nodiscard]] std::string first_difference(const nlohmann::ordered_json& got,
                                           const nlohmann::ordered_json& expected);

}  // namespace postlens
