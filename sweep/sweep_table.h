// What a sweep has made, picture by picture: as CSV for people's tools, and as JSON from which an
// interrupted sweep goes on.
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
    std::string file;    ///< name in the sweep's folder
    std::string method;  ///< what was used
    int depths = 0, views = 0;
    std::vector<double> coc_px;  ///< signed diameters, px, at the points asked for: positive behind the focus
    double largest_coc_px = 0;   ///< of all pixels, without its sign
    double in_focus_share = 0;
    std::optional<double> sharpness;     ///< absent where the pinhole picture is even
    std::optional<double> predicted_db;  ///< by `auto`, or asked for
    double seconds = 0;
    std::string settings_key;      ///< equal for equal settings of an equal file
    std::string picture_checksum;  ///< of the file as it was written
    bool kept = false;             ///< from an earlier run
};

struct SweepTable {
    std::string frame;  ///< the sample file
    std::vector<glm::dvec2> at;
    double coc_limit_px = 1;
    std::vector<SweepRow> rows;
};

/// One line a picture, the first the names of the columns: file, f_number, focal_length_mm, focus_m,
/// shutter_open_s, shutter_close_s, impulse, method, "coc_px X Y" for every point, largest_coc_px,
/// in_focus_share, sharpness, predicted_db, seconds. What is not known is empty, infinity is `inf`; texts
/// with commas or quotes are quoted [rfc4180].
[[nodiscard]] std::string csv_text(const SweepTable& table);

/// The same as JSON; null for what is not known and for infinity.
[[nodiscard]] std::string json_text(const SweepTable& table);

/// From the text of `json_text`, by the name of the file, the figures and checksums of each picture; the
/// settings are left out. Throws Error(invalid_input) that begins with `source` for anything else.
[[nodiscard]] std::map<std::string, SweepRow> rows_of_json(const std::string& text,
                                                           const std::string& source);

}  // namespace postlens
