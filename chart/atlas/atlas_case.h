// A case of the atlas of failures (docs/failures.md): a scene in which a method fails, together with the
// expected errors.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chart/chart_request.h"
#include "focus/responses/depth_levels.h"
#include "tracer/trace.h"

namespace postlens {

/// Settings of the trace that makes the sample file of a case. Settings that are absent keep the values that
/// `for_view` selects.
struct AtlasTrace {
    /// If true, the trace records all surfaces that the lens and shutter of the case need (best_trace). If
    /// false, it has default settings.
    bool for_view = true;
    std::optional<double> for_f_number;  ///< f-number for which to trace, if it is not that of the view
    /// Focus distance, m, for which to trace. If absent, the focus distance of the image is used.
    std::optional<double> for_focus_m;
    std::optional<int> levels;  ///< quadtree levels at depth edges and at colour edges
    std::optional<int> hidden_layers;
    std::optional<int> overscan_px;
    std::optional<int> keys;
    std::optional<int> max_depth;  ///< largest number of nodes along a path of the shading trees
    [[nodiscard]] bool operator==(const AtlasTrace&) const = default;
};

/// A method that makes an image, the settings of the method, and the limits for the error of the image.
struct AtlasMethod {
    /// Name of the method. For a lens alone: pinhole, scatter, layers, lightfield, or hybrid (which traces
    /// rays in the scene). For a shutter alone: convolve, lightfield, or auto. For both: lightfield, hybrid,
    /// or focus-after-shutter (which defocuses the motion-blurred image). In every case: rays (distributed
    /// ray tracing).
    std::string name;
    std::optional<int> views, depths;
    int spp = 64;  ///< samples per pixel of the method rays
    DepthModel depth_model = DepthModel::ray_differentials;
    DepthSpacing spacing = DepthSpacing::inverse;
    AtlasTrace trace;

    /// Smallest allowed PSNR against the reference, in dB. The noise of the reference is subtracted from the
    /// error first.
    double at_least_db = 0;
    std::optional<double> at_most_db;  ///< greatest PSNR, dB, of a method that is expected to fail
    double energy_within = 0;  ///< greatest |sum of the image / sum of the reference - 1| that is allowed
    /// Codes of the warnings that must occur, sorted. No other warnings may occur.
    std::vector<std::string> warnings;
};

struct AtlasCase {
    std::string name;  ///< name of the case's file, without extension
    std::string title;
    std::string set;    ///< "calibrate": error predictors may be fitted to this case; "check": they may not
    std::string cause;  ///< word of one of atlas_causes()
    std::string why, detection, outcome;  ///< sentences for the document
    ChartRequest view;   ///< scene, camera, lens, shutter and samples per pixel of the reference
    AtlasMethod method;  ///< the method under test
    std::optional<AtlasMethod> remedy;  ///< a method that is correct where `method` fails
    /// Smallest allowed fraction, 0 to 1, of the method's error that find_error_causes attributes to `cause`.
    double named_at_least = 0;
};

struct AtlasCause {
    std::string word, meaning;
};
/// Returns the causes of error, in the order of the atlas document (docs/failures.md). The last cause is
/// "none". It is used for cases that test extreme settings and expect no error.
[[nodiscard]] const std::vector<AtlasCause>& atlas_causes();

/// Reads a case from a TOML file. Throws Error(invalid_input) "FILE:LINE:COLUMN: ..." if the file does not
/// contain a valid case.
[[nodiscard]] AtlasCase read_atlas_case(const std::filesystem::path& path);

/// Returns the paths of the cases (*.toml) in a folder, sorted by name. Throws Error(invalid_input) if there
/// are none.
[[nodiscard]] std::vector<std::filesystem::path> atlas_case_files(const std::filesystem::path& folder);

}  // namespace postlens
