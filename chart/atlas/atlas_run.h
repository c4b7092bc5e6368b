// Runs a case of the atlas of failures: traces its scene, makes the images, and compares them to a reference.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "chart/atlas/atlas_case.h"
#include "chart/chart_data.h"

namespace postlens {

/// Values measured for the image of one method.
struct AtlasFigures {
    ChartError error, affected;         ///< the reference's noise is subtracted
    double energy = 1;                  ///< sum of the image / sum of the reference
    double least_value = 0;             ///< least finite channel value
    std::size_t nonfinite = 0;          ///< number of pixels with a NaN or an infinity
    std::vector<std::string> warnings;  ///< sorted codes
    double retraced_share = 0;
};

struct AtlasResult {
    std::string key;  ///< atlas_key of the case
    double pinhole_db = 0, noise_db = 0, affected_share = 0;
    AtlasFigures method;
    std::optional<AtlasFigures> remedy;
    /// Fraction, 0 to 1, of the method's error that has the cause which the test case expects. Absent if the
    /// test case expects no error.
    std::optional<double> named_share;
    std::string named_most;  ///< the cause to which most of the error is attributed
};

/// Returns a digest of everything that determines the result of a test case: scene, view, methods and program
/// version.
[[nodiscard]] std::string atlas_key(const AtlasCase& c);

/// Runs one atlas case. Temporary files are written to `folder`, which must exist. Throws Error.
///
/// Unless `strip` is empty, a picture with the images side by side is written there: method, remedy (a
/// correct method), reference, and the method's error map.
[[nodiscard]] AtlasResult run_atlas_case(const AtlasCase& c, const std::filesystem::path& folder,
                                         const std::filesystem::path& strip = {});

/// Returns one line for each expectation of a test case that its result does not meet: error, energy,
/// negative or nonfinite values, warnings, and the error's expected cause.
[[nodiscard]] std::vector<std::string> broken_expectations(const AtlasCase& c, const AtlasResult& r);

[[nodiscard]] nlohmann::ordered_json to_json(const AtlasResult& r);
/// Inverse of to_json. Throws Error(invalid_input), whose message names the file `path`.
[[nodiscard]] AtlasResult atlas_from_json(const std::string& text, const std::filesystem::path& path);

}  // namespace postlens
