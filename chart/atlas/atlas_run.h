// Runs one case of the atlas, a collection of scenes in which rendering methods may fail. For this, the scene
// of the case is traced, images are made by the methods under test, and these images are compared with a
// reference.
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
    /// How much of the image's squared error is due to the cause that the test case expects
    /// (AtlasCase::cause), as a fraction from 0 to 1. Absent if the test case expects no error.
    std::optional<double> named_share;
    std::string named_most;  ///< the cause to which most of the error is attributed
};

/// Returns a digest of everything that determines the result of a test case: scene, view, methods and program
/// version.
[[nodiscard]] std::string atlas_key(const AtlasCase& c);

/// Runs one test case of the atlas, a collection of scenes in which a rendering method may fail. Temporary
/// files are written to `folder`, which must exist. Throws Error.
///
/// If `strip` is not empty, a picture is written to this path. It shows the images that were compared side by
/// side, with an error map.
[[nodiscard]] AtlasResult run_atlas_case(const AtlasCase& c, const std::filesystem::path& folder,
                                         const std::filesystem::path& strip = {});

/// Returns one line for each expectation of the test case `c` that its result `r` does not meet. A case
/// states limits for the error and for the total energy of the image, the warnings, and the cause of the
/// error. Negative or nonfinite values are never expected.
[[nodiscard]] std::vector<std::string> broken_expectations(const AtlasCase& c, const AtlasResult& r);

[[nodiscard]] nlohmann::ordered_json to_json(const AtlasResult& r);
/// Inverse of to_json. Throws Error(invalid_input), whose message names the file `path`.
[[nodiscard]] AtlasResult atlas_from_json(const std::string& text, const std::filesystem::path& path);

}  // namespace postlens
