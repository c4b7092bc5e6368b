// A case of the atlas of failure: a scene that breaks a method, and what is expected to happen.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chart/chart_request.h"
#include "focus/depth_levels.h"
#include "tracer/trace.h"

namespace postlens {

/// What the sample file is traced for; what is absent is best_trace's.
struct AtlasTrace {
    bool for_view = true;                ///< false: a plain trace that knows of neither lens nor shutter
    std::optional<double> for_f_number;  ///< another lens than the one asked for
    std::optional<double> for_focus_m;   ///< another focus than the one asked for
    std::optional<int> levels;           ///< of subdivision, for edges and colours alike
    std::optional<int> hidden_layers;
    std::optional<int> overscan_px;
    std::optional<int> keys;
    std::optional<int> max_depth;  ///< of the shading trees
    [[nodiscard]] bool operator==(const AtlasTrace&) const = default;
};

/// A way to make the picture, and what it is held to.
struct AtlasMethod {
    /// Of focus: pinhole, scatter, layers, lightfield, hybrid (with its scene). With a shutter alone:
    /// convolve, lightfield, auto. With both: lightfield, hybrid, and focus-after-shutter, which puts the
    /// picture of the shutter through the lens. Everywhere: rays.
    std::string name;
    std::optional<int> views, depths;
    int spp = 64;  ///< of rays
    DepthModel depth_model = DepthModel::ray_differentials;
    DepthSpacing spacing = DepthSpacing::inverse;
    AtlasTrace trace;

    double at_least_db = 0;             ///< PSNR above the noise of the reference
    std::optional<double> at_most_db;   ///< it fails: no better than this
    double energy_within = 0;           ///< the sum over the picture, relative to the reference's
    std::vector<std::string> warnings;  ///< codes, sorted: these and no others
};

struct AtlasCase {
    std::string name;  ///< of its file
    std::string title;
    std::string set;    ///< "calibrate" or "check": which half of the cases a prediction may learn from
    std::string cause;  ///< one of atlas_causes()
    std::string why, detection, outcome;  ///< sentences
    ChartRequest view;                    ///< scene, camera, lens, shutter, samples of the reference
    AtlasMethod method;                   ///< the one on trial
    std::optional<AtlasMethod> remedy;    ///< one that is right where `method` is not
    /// Share of the error that find_error_causes must put down to `cause`.
    double named_at_least = 0;
};

struct AtlasCause {
    std::string word, meaning;
};
/// What may be wrong, in the order of the document; the last, "none", is of limits that must stay right.
[[nodiscard]] const std::vector<AtlasCause>& atlas_causes();

/// Throws Error(invalid_input) "FILE:LINE:COLUMN: ..." for what is not a case.
[[nodiscard]] AtlasCase read_atlas_case(const std::filesystem::path& path);

/// The cases (*.toml) of a folder, by name. Throws Error(invalid_input) where there is none.
[[nodiscard]] std::vector<std::filesystem::path> atlas_case_files(const std::filesystem::path& folder);

}  // namespace postlens
