// Functions for dividing the work of a command between several machines. Each machine computes one share of
// the work and writes a result file. This file contains a mark, i.e. JSON that describes the share and the
// command. By this mark, `merge` recognises the files that belong together.
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

/// Parses the value I/N of the option `option`, which means the I-th of N shares of the work. N is at most
/// 100000, and I is from 0 to N - 1. Throws Error(wrong_arguments), which names the option.
[[nodiscard]] Share parse_share(std::string_view option, std::string_view text);

/// Returns the rows of the image that form a share of the work. They are part of `crop`, or of the whole
/// image (`width` x `height`) if there is no crop. The shares have equally many rows, or differ by one row.
/// Throws Error(wrong_arguments) if there are more shares than rows.
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
    /// Returns the fingerprint of the command, JSON that identifies the result. It contains the version of
    /// postlens, the options, and the SHA-256 of each input file, so commands with equal fingerprints have
    /// equal results. Throws Error(invalid_input) if an input file cannot be read.
    [[nodiscard]] nlohmann::ordered_json fingerprint(
        const std::function<std::string(const Input&)>& file_of = {}) const;
};

/// Stores the SHA-256 hash of the scene at `path`, which was already read. Later, AskedFor::fingerprint needs
/// the hashes of all input files of the command. It then uses the stored hash and need not read the scene
/// again.
void remember_digest(const std::string& path, const Scene& scene);

/// Returns the mark of a result file, if several machines divide a command (--share). The mark is JSON in
/// this file, by which `merge` recognises it. It contains this machine's share, the crop of the whole image,
/// and the command's fingerprint.
[[nodiscard]] std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop);

/// Returns the share (I of N) of the work whose result a file contains. `mark` is the JSON that mark_of
/// returned and that is stored in this file. Returns nothing if `mark` is invalid, for example because the
/// file is damaged.
[[nodiscard]] std::optional<Share> share_of_mark(const std::string& mark);

/// Returns the mark of a result file (JSON stored in it), if several machines divide the images of `sweep` or
/// the measurements of `chart`. Unlike the mark of mark_of, it also contains the command-line arguments
/// `words`, because `merge` runs the command again to join the results.
[[nodiscard]] std::string mark_of_items(const Share& share, const AskedFor& asked,
                                        const std::vector<std::string>& words);
/// Returns the command-line arguments that mark_of_items stored in `mark`, or nothing if they are absent or
/// damaged. In `mark`, every % and every byte outside ASCII is written as %XX (two hexadecimal digits),
/// because JSON must be UTF-8.
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
