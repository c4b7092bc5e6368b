// Properties of a frame, as stored in the header of a sample file.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "records/motion/scene_motion.h"

namespace postlens {

enum class Projection { perspective, orthographic };

/// The range of lens and shutter settings for which the file contains enough overscan (pixels outside the
/// image) and hidden surfaces. A limit is absent if the user did not state it when tracing the file.
struct SufficientRange {
    std::optional<double> smallest_f_number;
    std::optional<double> nearest_focus_m, farthest_focus_m;  ///< farthest may be infinite
    std::optional<double> shutter_open_s, shutter_close_s;    ///< either both are set or none
};

struct SampleHeader {
    static constexpr int current_version = 2;
    static constexpr std::size_t most_keys = 64;

    int version = current_version;
    int width = 0, height = 0;  ///< raster in px; pixel centres at (i + 0.5, j + 0.5), y downwards
    int overscan_px = 0;        ///< pixels with records beyond each of the four sides

    Projection projection = Projection::perspective;
    double film_distance_mm = 0;  ///< from the pinhole to the film; perspective only
    double pixel_pitch_mm = 0;    ///< on the film; for an orthographic camera, size of a pixel in the scene
    double focal_length_mm = 0;   ///< nominal focal length, the default of the command `focus`
    std::optional<double> f_number;
    std::optional<double> focus_m;  ///< may be infinite
    std::optional<double> exposure_s;
    glm::dmat4 world_from_camera{1};  ///< in metres; the camera's x points right, y up, and it looks along -z
    double time_s = 0;                ///< instant of the trace and of the pinhole image
    /// Further instants at which a moving scene is recorded, in seconds, besides the instant `time_s`. They
    /// are in ascending order. There are at most `most_keys`, and none if only the instant `time_s` is
    /// recorded.
    std::vector<double> key_times_s;

    int subdivide_levels = 0;  ///< largest number of recursive 2x2 subdivisions of a pixel
    double subdivide_threshold = 0;
    int max_depth = 0;            ///< nodes along a path, including the primary node
    double min_contribution = 0;  ///< nodes that contribute less are not recorded; 1 is white

    double exposure_stops = 0;  ///< white has the radiance 2^-exposure_stops; records store radiance
    std::optional<double> auto_exposure_stops;  ///< result of `--exposure auto` for this scene and camera
    std::optional<double> lumens_per_watt;  ///< factor by which the scene's photometric lights were divided
    std::optional<double> metres_per_unit;  ///< unit of lengths in the scene; absent in older files

    std::string scene_name;
    std::string scene_sha256;
    std::string made_by;                                ///< how the file was made; empty if unknown
    std::map<std::uint32_t, std::string> object_names;  ///< without id 0
    std::vector<std::uint32_t> moving_ids;
    bool lights_move = false;
    SceneMotion motion;

    bool has_w = false;       ///< if false, all nodes are primary, and W is the unit matrix / z'
    bool has_layers = false;  ///< if false, all records are of layer 0
    bool has_bend = false;    ///< if false, the error of W was not measured; requires has_w
    bool has_marks = false;   ///< if false, no record has a mark
    SufficientRange sufficient;
};

}  // namespace postlens
