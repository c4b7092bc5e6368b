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

/// Parses a share I/N, where N is at most 100000 and I is from 0 to N - 1. Throws Error(wrong_arguments),
/// which names the option.
[[nodiscard]] Share parse_share(std::string_view option, std::string_view text);

/// Returns the rows of the image that form a share of the work. They are a part of `crop`, or of the whole
/// image of size `width` x `height` if there is no crop. All shares have equally many rows, or differ by one
/// row. Throws Error(wrong_arguments) if there are more shares than rows.
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

/// Stores the SHA-256 hash of the scene at `path`, which was already read. The fingerprint of a command
/// (AskedFor::fingerprint) contains the hashes of all its input files. With the stored hash, it need not read
/// the scene once more.
void remember_digest(const std::string& path, const Scene& scene);

/// Returns the mark of a result file, if several machines divide a command (--share). The mark is JSON that
/// is stored in this file. It contains this machine's share, the crop of the whole image, and the command's
/// fingerprint. By the mark, `merge` recognises the file and the command to which it belongs.
[[nodiscard]] std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop);

/// Returns the share (I of N) of the work whose result a file contains. `mark` is the JSON that mark_of
/// returned and that is stored in this file. Returns nothing if `mark` is invalid, for example because the
/// file is damaged.
[[nodiscard]] std::optional<Share> share_of_mark(const std::string& mark);

/// Returns JSON that is stored in a result file if several machines divide the images of a sweep or the
/// points of a chart. By this mark, `merge` recognises the file. The mark contains this machine's share, the
/// command's fingerprint (mark_of) and the command-line arguments `words`. With these arguments, `merge` runs
/// the command again to join the results.
[[nodiscard]] std::string mark_of_items(const Share& share, const AskedFor& asked,
                                        const std::vector<std::string>& words);
/// Returns the command-line arguments that mark_of_items stored in `mark`. JSON must be UTF-8, but arguments
/// may contain any bytes. Therefore, `mark` contains % and all bytes that are not ASCII as %XX, and this
/// function converts them back. Returns nothing if `mark` contains no arguments or if they are damaged.
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
