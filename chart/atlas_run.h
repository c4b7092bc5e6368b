// Runs a case of the atlas: traces, makes both pictures and the reference, compares.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "chart/atlas_case.h"
#include "chart/chart_data.h"

namespace postlens {

/// What came of one method.
struct AtlasFigures {
    ChartError error, affected;         ///< above the noise of the reference
    double energy = 1;                  ///< sum over the picture / sum over the reference
    double least_value = 0;             ///< of all channels of finite pixels
    std::size_t nonfinite = 0;          ///< pixels with a NaN or an infinity
    std::vector<std::string> warnings;  ///< codes, sorted
    double retraced_share = 0;
};

struct AtlasResult {
    std::string key;  ///< of everything that decides the figures
    double pinhole_db = 0, noise_db = 0, affected_share = 0;
    AtlasFigures method;
    std::optional<AtlasFigures> remedy;
    /// Share of the method's error that find_error_causes puts down to the case's cause; absent for "none".
    std::optional<double> named_share;
    std::string named_most;  ///< the cause with the largest share
};

/// Digest of scene, view, methods and program version: of all that decides a result, not of what is expected.
[[nodiscard]] std::string atlas_key(const AtlasCase& c);

/// Works in `folder`, which must exist; files of its own are removed. `strip`: where to write the pictures
/// side by side (method, remedy, reference, error map of the method, 4 px apart); empty: nowhere.
/// Throws Error.
[[nodiscard]] AtlasResult run_atlas_case(const AtlasCase& c, const std::filesystem::path& folder,
                                         const std::filesystem::path& strip = {});

/// One line for each thing that is not as the case expects: error, energy, finite, non-negative, warnings.
[[nodiscard]] std::vector<std::string> broken_expectations(const AtlasCase& c, const AtlasResult& r);

[[nodiscard]] nlohmann::ordered_json to_json(const AtlasResult& r);
/// Throws Error(invalid_input), naming `path`.
[[nodiscard]] AtlasResult atlas_from_json(const std::string& text, const std::filesystem::path& path);

}  // namespace postlens
