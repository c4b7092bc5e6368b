// The table of a sweep, which is a series of images with different lens settings. The table has one row for
// each image, and is written as CSV and as JSON. A later run with --resume reads the JSON table.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sweep/grid.h"

namespace postlens {

struct SweepRow {
    SweepSetting setting;
    std::string file;    ///< name of the image file in the sweep's folder
    std::string method;  ///< method used
    int depths = 0, views = 0;
    std::vector<double> coc_px;  ///< signed CoC diameters at SweepTable::at, px; positive behind the focus
    double largest_coc_px = 0;   ///< largest absolute CoC diameter of all pixels, px
    double in_focus_share = 0;
    /// Sharpness of this image: its sum of squared differences between neighbouring pixels, divided by that
    /// of the pinhole image. Absent if the pinhole image has no detail.
    std::optional<double> sharpness;
    std::optional<double> predicted_db;  ///< stated or predicted PSNR, dB
    double seconds = 0;
    std::string settings_key;      ///< hash of the settings and of the file's contents
    std::string picture_checksum;  ///< checksum of the image file as written
    bool kept = false;             ///< true if an earlier run made the image
};

struct SweepTable {
    std::string frame;  ///< path of the sample file
    std::vector<glm::dvec2> at;
    double coc_limit_px = 1;
    std::vector<SweepRow> rows;
    std::string part;  ///< SweepSettings::part
};

/// Returns the table as CSV, one line per image. Unknown values are empty, and infinity is `inf`. Strings
/// with commas or quotes are quoted [rfc4180].
///
/// Columns: file, f_number, focal_length_mm, focus_m, shutter_open_s, shutter_close_s, impulse, method,
/// "coc_px X Y" for every position, largest_coc_px, in_focus_share, sharpness, predicted_db, seconds.
[[nodiscard]] std::string csv_text(const SweepTable& table);

/// Returns the table as JSON, with null for unknown and infinite values.
[[nodiscard]] std::string json_text(const SweepTable& table);

/// Returns a file name as json_text writes it: bytes that are not UTF-8 are replaced, because JSON must be
/// UTF-8.
[[nodiscard]] std::string name_in_json(const std::string& name);

/// Reads the measured values and checksums of images from `text`, which json_text has written. The result
/// maps the name of each image file to its values. For any other text, throws Error(invalid_input) with a
/// message that begins with `source`.
[[nodiscard]] std::map<std::string, SweepRow> rows_of_json(const std::string& text,
                                                           const std::string& source);

}  // namespace postlens
