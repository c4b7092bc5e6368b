// A case of the atlas of failures (docs/failures.md): a scene in which a method fails.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chart/chart_request.h"
#include "focus/responses/depth_levels.h"
#include "tracer/trace.h"

namespace postlens {

struct AtlasTrace {
    /// States how the sample file of the test image is traced. If true, it is traced for the lens and the
    /// shutter of the test image, so it contains all surfaces that they can see. If false, it is traced with
    /// default settings, so hidden surfaces may be missing.
    bool for_view = true;
    std::optional<double> for_f_number;  ///< f-number for which to trace, if it is not that of the view
    /// Focus distance for which to trace, m. If absent, the image's.
    std::optional<double> for_focus_m;
    std::optional<int> levels;  ///< quadtree levels at depth edges and at colour edges
    std::optional<int> hidden_layers;
    std::optional<int> overscan_px;
    std::optional<int> keys;
    std::optional<int> max_depth;  ///< largest number of nodes along a path of the shading trees
    [[nodiscard]] bool operator==(const AtlasTrace&) const = default;
};

struct AtlasMethod {
    /// Name of the method that makes the test image. The possible methods depend on what blurs the image in
    /// this test case: a lens (depth of field), a shutter (motion blur) or both. docs/glossary.md explains
    /// most of them.
    /// - With a lens: pinhole, scatter, layers, lightfield, hybrid.
    /// - With a shutter: convolve (blurs each object along its path), lightfield, auto.
    /// - With both: lightfield, hybrid, focus-after-shutter (motion blur first, then the lens).
    /// - Always: rays (distributed ray tracing).
    std::string name;
    std::optional<int> views, depths;
    int spp = 64;  ///< samples per pixel of the method rays
    DepthModel depth_model = DepthModel::ray_differentials;
    DepthSpacing spacing = DepthSpacing::inverse;
    AtlasTrace trace;

    /// Smallest allowed PSNR, in dB, without the noise of the reference.
    double at_least_db = 0;
    std::optional<double> at_most_db;  ///< greatest PSNR, dB, of a method that is expected to fail
    double energy_within = 0;  ///< greatest |sum of the image / sum of the reference - 1| that is allowed
    /// Codes of exactly those warnings that must occur, sorted.
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
    /// The test case expects that the image made by `method` has an error with the cause `cause`. At least
    /// this fraction of the error, from 0 to 1, must have this cause, as estimated by find_error_causes.
    /// Otherwise, the test fails.
    double named_at_least = 0;
};

struct AtlasCause {
    std::string word, meaning;
    std::string source;  ///< what the error comes from, in a few words
};
/// Returns the causes of errors that a test case may name as the expected one. They are in the order of
/// docs/failures.md, where they are described. The last cause, "none", is for test cases in which no error is
/// expected.
[[nodiscard]] const std::vector<AtlasCause>& atlas_causes();

/// Reads a case from a TOML file. Throws Error(invalid_input) "FILE:LINE:COLUMN: ...".
[[nodiscard]] AtlasCase read_atlas_case(const std::filesystem::path& path);

/// Returns the files *.toml in a folder, sorted by name. Each describes one test case. Throws
/// Error(invalid_input) if there are none.
[[nodiscard]] std::vector<std::filesystem::path> atlas_case_files(const std::filesystem::path& folder);

}  // namespace postlens
