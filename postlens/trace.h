/// @file
/// Traces a scene through a pinhole and writes a sample file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Value for integer settings such as `hidden_layers`. It means that the number is chosen automatically
/// (`auto` on the command line).
inline constexpr int automatic = -1;

/// Settings of `trace`.
struct TraceSettings {
    std::optional<Size> size = {};  ///< Raster of the pictures (`--size`). Default: the camera's.
    std::string camera = {};        ///< Camera by name (`--camera`). Default: the scene's first.
    /// Instant of the trace on the scene's clock, in s (`--time`). Default: the instant in the scene.
    std::optional<double> time_s = {};
    /// Smallest f-number of the pictures that will be made from the file, more than 0 (`--for-f-number`).
    std::optional<double> for_f_number = {};
    /// Focus distance of the pictures that will be made from the sample file, in m, more than 0
    /// (`--for-focus`). It may be infinite. It is used to choose an `automatic` `overscan_px`, because it
    /// affects how far the lens blurs light into the picture from outside.
    std::optional<double> for_focus_distance_m = {};
    /// Time interval that contains the exposures of all pictures that will be made from the file
    /// (`--for-shutter`).
    std::optional<Shutter> for_shutter = {};
    /// Set this to true if every picture that is made from the file will also trace rays into the scene
    /// (`--for-rays`). These rays compute the colours of surfaces that are not recorded. Therefore, fewer
    /// surfaces are recorded, and the file is smaller.
    bool for_rays = false;
    /// How many times a pixel may be divided into 2x2 cells, recursively, from 0 to 8 (`--subdivide`). More
    /// divisions make edges more exact, but the file larger. The default is 2. If `for_f_number` is set, the
    /// default is 3 at the borders of objects. If `for_rays` is set, it is 1.
    std::optional<int> subdivide = {};
    /// Limit for the contrast between the corners of a pixel (`--threshold`), 0 or more. A pixel is divided
    /// into four cells if its contrast is larger in any colour channel, and so is a cell. The contrast is
    /// (max - min) / (max + min + 0.05), where max and min are the largest and the smallest radiance at the
    /// corners.
    std::optional<double> threshold = {};
    /// Number of surfaces that are recorded behind each visible surface, from 0 to 16, or `automatic`
    /// (`--hidden-layers`). A lens or a moving object can reveal these surfaces. The default is `automatic`
    /// if `for_f_number` or `for_shutter` is set, otherwise 0.
    std::optional<int> hidden_layers = {};
    /// Number of pixels traced beyond each border of the picture, or `automatic` (`--overscan`). Default: 0.
    std::optional<int> overscan_px = {};
    /// Number of instants of the interval `for_shutter` at which a moving scene is recorded, from 1 to 64
    /// (`--keys`). With `automatic`, the number depends on the motion. Default: 1.
    std::optional<int> keys = {};
    /// Exposure of pictures made from the file, in stops from -100 to 100 (`--exposure`). Default: 0.
    std::optional<double> exposure = {};
    /// Further options of `postlens trace`, for example {"--plan", "--target-db=40"}.
    std::vector<std::string> options = {};
};

/// What `trace` has done.
struct TraceResult {
    std::uint64_t records = 0;  ///< Number of records in the file.
    std::uint64_t bytes = 0;    ///< Size of the file in bytes.
    /// Number of rays through the pinhole. The JSON of `report` also has the numbers of other rays, such as
    /// shadow rays.
    std::uint64_t eye_rays = 0;
    int overscan_px = 0;  ///< Pixels traced beyond each border of the picture.
    Report report = {};   ///< Report of `postlens trace`.
};

/// Traces a scene through a pinhole [Whitted 1980] and writes the sample file `output`. The formats of scenes
/// are .toml, .nff, .gltf, .glb, .obj and .ply.
///
/// Throws Error(invalid_input) for an invalid scene. Throws Error(wrong_arguments) for a wrong setting, or if
/// the scene refers to the file `output`. Throws Error(cannot_write) if the file cannot be written, and
/// Error(out_of_memory) if the memory does not suffice.
/// @param scene The scene file.
/// @param output The sample file to write (.exr). An existing file is replaced.
/// @param settings The camera, and the lens and shutter of the pictures that will be made.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The results of the trace.
TraceResult trace(const std::filesystem::path& scene, const std::filesystem::path& output,
                  const TraceSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
