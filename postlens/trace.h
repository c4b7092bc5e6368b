/// @file
/// Traces a scene through a pinhole into a sample file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Value of a count that the command is to choose itself (`auto`).
inline constexpr int automatic = -1;

/// Settings of `trace`.
struct TraceSettings {
    std::optional<Size> size = {};  ///< Raster of the pictures (`--size`). Default: the camera's.
    std::string camera = {};        ///< Camera by name (`--camera`). Default: the scene's first.
    /// Instant of the trace on the scene's clock, s (`--time`). Default: that of the scene.
    std::optional<double> time_s = {};
    /// Smallest f-number for which the records must suffice, more than 0 (`--for-f-number`).
    std::optional<double> for_f_number = {};
    /// Focus distance for which an `automatic` overscan must suffice, m, more than 0; may be infinite
    /// (`--for-focus`).
    std::optional<double> for_focus_distance_m = {};
    /// Exposure time for which the records must suffice (`--for-shutter`).
    std::optional<Shutter> for_shutter = {};
    /// The file is only used for pictures that are made with rays into the scene, so fewer records suffice
    /// (`--for-rays`).
    bool for_rays = false;
    /// Greatest depth of the recursive division of a pixel into 2x2 cells, 0 to 8 (`--subdivide`). Default:
    /// 2. With `for_f_number` it is 3 at the borders of objects, with `for_rays` 1.
    std::optional<int> subdivide = {};
    /// A cell is divided if the contrast of its corners exceeds this value, 0 or more (`--threshold`).
    std::optional<double> threshold = {};
    /// Number of surfaces recorded behind each visible one, 0 to 16, or `automatic` (`--hidden-layers`).
    /// Default: `automatic` with `for_f_number` or `for_shutter`, else 0.
    std::optional<int> hidden_layers = {};
    /// Number of pixels traced beyond each border, or `automatic` (`--overscan`). Default: 0.
    std::optional<int> overscan_px = {};
    /// Number of instants recorded during `for_shutter`, 1 to 64, or `automatic` (`--keys`). Default: 1.
    std::optional<int> keys = {};
    /// Exposure of pictures made from the file, stops, -100 to 100 (`--exposure`). Default: 0.
    std::optional<double> exposure = {};
    /// Further options of `postlens trace`, for example {"--plan", "--target-db=40"}.
    std::vector<std::string> options = {};
};

/// What `trace` has done.
struct TraceResult {
    std::uint64_t records = 0;  ///< Number of records in the file.
    std::uint64_t bytes = 0;    ///< Size of the file.
    /// Number of rays through the pinhole. The JSON has the numbers of all kinds of rays.
    std::uint64_t eye_rays = 0;
    int overscan_px = 0;  ///< Pixels traced beyond each border, px.
    Report report = {};   ///< Of `postlens trace`.
};

/// Traces a scene (.toml, .nff, .gltf, .glb, .obj or .ply) through a pinhole [Whitted 1980] and writes the
/// sample file `output` (.exr).
///
/// Throws Error(invalid_input) for an invalid scene, Error(wrong_arguments) for a wrong setting or an output
/// to which the scene refers, Error(cannot_write), and Error(out_of_memory).
/// @param scene The scene file.
/// @param output The sample file to write (.exr); an older file is replaced.
/// @param settings Camera, and the lens and shutter for which the records suffice.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The results of the trace.
TraceResult trace(const std::filesystem::path& scene, const std::filesystem::path& output,
                  const TraceSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
