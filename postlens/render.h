/// @file
/// Renders a reference picture with rays that are distributed over the lens, the shutter and the lights.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <postlens/lens.h>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Settings of `render`.
struct RenderSettings {
    int spp = 0;                    ///< Samples per pixel, 1 to 1048576 (`--spp`); required.
    LensSettings lens = {};         ///< Default: the lens of the camera.
    std::optional<Size> size = {};  ///< Raster (`--size`). Default: the camera's.
    std::string camera = {};        ///< Camera by name (`--camera`). Default: the scene's first.
    /// Instant at which the scene is rendered if there is no shutter, in s (`--time`). Default: the instant
    /// stated in the scene file.
    std::optional<double> time_s = {};
    std::optional<Shutter> shutter = {};  ///< Exposure time (`--shutter`). Default: an instant.
    /// How much light the shutter transmits at each instant while it is open (`--shutter-curve`): "box"
    /// (default, constant), "triangle", or the name of a file that contains the curve.
    std::string shutter_curve = {};
    /// "grid", "jittered", "random", "poisson" or "sobol" (`--sampler`).
    std::string sampler = {};
    std::optional<std::uint64_t> seed = {};  ///< Seed of all random numbers (`--seed`). Default: 0.
    bool halves = false;                     ///< Also returns two pictures of half the samples (`--halves`).
    std::optional<Crop> crop = {};           ///< Renders only this part (`--crop`).
    std::optional<double> exposure = {};     ///< Stops, -100 to 100 (`--exposure`). Default: 0.
    /// Further options of `postlens render`, for example {"--max-depth=4"}.
    std::vector<std::string> options = {};
};

/// What `render` has made.
struct RenderResult {
    /// The rendered picture. If `crop` of the settings is set, it contains only this part of the whole
    /// picture. If `options` of the settings contains `--output`, the picture is written to that file
    /// instead, and this field is empty.
    Picture picture = {};
    /// With `halves`: two pictures from independent halves of the samples. Their difference measures the
    /// noise.
    std::vector<Picture> halves = {};
    double focal_length_mm = 0;   ///< Focal length that was used, mm.
    double f_number = 0;          ///< F-number that was used; infinite for a pinhole.
    double focus_distance_m = 0;  ///< Focus distance that was used, m. It may be infinite.
    Report report = {};           ///< Report of `postlens render`.
};

/// Renders a scene by distributed ray tracing [Cook, Porter & Carpenter 1984]. The scene has one of the
/// formats that `trace` reads.
///
/// Throws Error(invalid_input) for an invalid scene, Error(wrong_arguments) for a wrong setting, and
/// Error(out_of_memory) if the memory does not suffice.
/// @param scene The scene file.
/// @param settings Camera, lens, shutter and samples.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The picture, and the lens that was used.
[[nodiscard]] RenderResult render(const std::filesystem::path& scene, const RenderSettings& settings,
                                  Job* job = nullptr);

}  // namespace postlens::api
