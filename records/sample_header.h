// What a sample file says of the picture as a whole.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "records/scene_motion.h"

namespace postlens {

enum class Projection { perspective, orthographic };

/// Lens and shutter that the traced records (overscan, hidden layers) were sized for. Absent: any not asked
/// for.
struct SufficientRange {
    std::optional<double> smallest_f_number;
    std::optional<double> nearest_focus_m, farthest_focus_m;  ///< farthest may be infinite
    std::optional<double> shutter_open_s, shutter_close_s;    ///< both or none
};

struct SampleHeader {
    static constexpr int current_version = 2;
    static constexpr std::size_t most_keys = 64;

    int version = current_version;
    int width = 0, height = 0;  ///< raster, px: pixel centres at (i + 0.5, j + 0.5), y downwards
    int overscan_px = 0;        ///< further pixels on all four sides that have records too

    Projection projection = Projection::perspective;
    double film_distance_mm = 0;  ///< d, pinhole to film; perspective only
    double pixel_pitch_mm = 0;    ///< on the film; for an orthographic camera the pixel's size in the scene
    double focal_length_mm = 0;   ///< nominal F, what `focus` takes when none is asked for
    std::optional<double> f_number;
    std::optional<double> focus_m;  ///< may be infinite
    std::optional<double> exposure_s;
    glm::dmat4 world_from_camera{1};  ///< camera frame: x right, y up, looking along -z; metres
    double time_s = 0;                ///< the instant of the trace, and of the picture
    /// Further instants at which records were taken, growing, none of them `time_s`; at most `most_keys`.
    std::vector<double> key_times_s;

    int subdivide_levels = 0;  ///< greatest depth of the recursive 2x2 subdivision of a pixel
    double subdivide_threshold = 0;
    int max_depth = 0;            ///< nodes along a path, the primary node counts 1
    double min_contribution = 0;  ///< of white

    double exposure_stops = 0;  ///< radiance times 2^this is relative to white; the file holds radiance
    std::optional<double> auto_exposure_stops;  ///< what `--exposure auto` is for this scene and camera
    std::optional<double> lumens_per_watt;      ///< by which the scene's photometric lights were divided

    std::string scene_name;
    std::string scene_sha256;
    std::map<std::uint32_t, std::string> object_names;  ///< without id 0
    std::vector<std::uint32_t> moving_ids;
    bool lights_move = false;
    SceneMotion motion;

    bool has_w = false;       ///< false: no node is deeper than primary, W is I / z' everywhere
    bool has_layers = false;  ///< false: every record is of layer 0
    bool has_bend = false;    ///< only with W; false: how far W errs was not measured
    bool has_marks = false;   ///< false: no record says what it does not tell
    SufficientRange sufficient;
};

}  // namespace postlens
