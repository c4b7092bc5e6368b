// Reads PATHS.toml (docs/motion_paths.md): paths of moving objects, which replace the paths of the sample
// file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "motionblur/paths/screen_path.h"
#include "records/motion/transform_key.h"
#include "reproject/raster_map.h"

namespace postlens {

/// Largest size of the file, bytes. A larger file is rejected before it is read.
inline constexpr std::uintmax_t largest_paths_bytes = 256'000'000;

/// Rigid motion in scene coordinates, m. There is at least one key; times increase.
using RigidKeys = std::vector<TransformKey>;

/// A motion and the objects that it moves. Only differences matter: at time t, an object is displaced by
/// r'(t) - r'(time of the frame).
struct ObjectPath {
    std::vector<std::uint32_t> ids;    ///< each is at least 1 and occurs once
    std::vector<std::string> objects;  ///< names in the sample file
    std::string source;                ///< "FILE:LINE" of the [[path]]
    std::variant<ScreenPath, RigidKeys> motion;
};

/// Reads the file. Throws Error(invalid_input) "FILE:LINE:COLUMN: ...", or "FILE: ..." if `path` is not a
/// regular file.
[[nodiscard]] std::vector<ObjectPath> read_paths(const std::filesystem::path& path);

/// Returns the ids that each path moves, in the order of `paths`: the path's own ids and all ids with one of
/// its names. Throws Error(invalid_input) "FILE:LINE: ..." for an id or a name that `names` (name by id) does
/// not contain, and for an id that two paths move.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> resolve_ids(
    const std::vector<ObjectPath>& paths, const std::map<std::uint32_t, std::string>& names);

/// Returns the motion of the sample file's objects. For objects in `paths`, the path replaces the file's
/// motion. Throws the errors of resolve_ids.
[[nodiscard]] FrameMotion motion_of(const SampleHeader& header, const std::vector<ObjectPath>& paths);

}  // namespace postlens
