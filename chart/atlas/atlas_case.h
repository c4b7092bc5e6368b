// A case of the atlas of failure (docs/failures.md): a scene for which a method fails,
// and the expected figures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chart/chart_request.h"
#include "focus/responses/depth_levels.h"
#include "tracer/trace.h"

namespace postlens {

/// Settings of the trace that makes the sample file. Absent settings are those of best_trace.
struct AtlasTrace {
    bool for_view = true;                ///< false: default trace settings, without lens and shutter
    std::optional<double> for_f_number;  ///< f-number to trace for, if not the view's
    std::optional<double> for_focus_m;   ///< focus distance to trace for, if not the view's
    std::optional<int> levels;           ///< quadtree levels at depth edges and at colour edges
    std::optional<int> hidden_layers;
    std::optional<int> overscan_px;
    std::optional<int> keys;
    std::optional<int> max_depth;  ///< nodes along a path of the shading trees
    [[nodiscard]] bool operator==(const AtlasTrace&) const = default;
};

/// A method of making the image, its settings, and limits for the error of its image.
struct AtlasMethod {
    /// With a lens alone: pinhole, scatter, layers, lightfield or hybrid (which traces rays in the scene).
    /// With a shutter alone: convolve, lightfield or auto. With both: lightfield, hybrid or
    /// focus-after-shutter, which defocuses the motion-blurred image. In every case: rays, which is
    /// distributed ray tracing.
    std::string name;
    std::optional<int> views, depths;
    int spp = 64;  ///< samples per pixel of the method rays
    DepthModel depth_model = DepthModel::ray_differentials;
    DepthSpacing spacing = DepthSpacing::inverse;
    AtlasTrace trace;

    double at_least_db = 0;  ///< least PSNR, dB; the noise of the reference is subtracted from the error
    std::optional<double> at_most_db;   ///< greatest PSNR, dB, of a method that is expected to fail
    double energy_within = 0;           ///< greatest |sum of the image / sum of the reference - 1|
    std::vector<std::string> warnings;  ///< sorted codes of exactly the warnings that must occur
};

struct AtlasCase {
    std::string name;  ///< name of the case's file, without extension
    std::string title;
    std::string set;    ///< "calibrate": predictors may be fitted to this case; "check": they may not
    std::string cause;  ///< word of one of atlas_causes()
    std::string why, detection, outcome;  ///< sentences for the document
    ChartRequest view;   ///< scene, camera, lens, shutter and samples per pixel of the reference
    AtlasMethod method;  ///< the method under test
    std::optional<AtlasMethod> remedy;  ///< a method that is correct where `method` fails
    /// Least share of the error, 0 to 1, that find_error_causes must attribute to `cause`.
    double named_at_least = 0;
};

struct AtlasCause {
    std::string word, meaning;
};
/// The causes of error, in the order in which the atlas document lists them. The last entry, "none", is for
/// cases with extreme settings that must not fail.
[[nodiscard]] const std::vector<AtlasCause>& atlas_causes();

/// Reads a case from a TOML file. Throws Error(invalid_input) "FILE:LINE:COLUMN: ..." if it is not valid.
[[nodiscard]] AtlasCase read_atlas_case(const std::filesystem::path& path);

/// Paths of the cases (*.toml) in a folder, sorted by name. Throws Error(invalid_input) if there are none.
[[nodiscard]] std::vector<std::filesystem::path> atlas_case_files(const std::filesystem::path& folder);

}  // namespace postlens
