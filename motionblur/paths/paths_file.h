// Reads PATHS.toml (docs/motion_paths.md). It contains paths of moving objects, which replace the paths of
// the sample file.
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

/// Largest accepted size of a paths file, in bytes. A larger file is rejected before it is read.
inline constexpr std::uintmax_t largest_paths_bytes = 256'000'000;

/// Keyframes of a rigid motion in scene coordinates, in m. There is at least one keyframe, and the times
/// increase.
using RigidKeys = std::vector<TransformKey>;

/// A motion, and the objects that it moves. At time t, an object is displaced by the difference between the
/// motion's position at t and its position at the time of the frame.
struct ObjectPath {
    std::vector<std::uint32_t> ids;    ///< each is at least 1 and occurs once
    std::vector<std::string> objects;  ///< names in the sample file
    std::string source;                ///< "FILE:LINE" of the [[path]]
    std::variant<ScreenPath, RigidKeys> motion;
};

/// Reads a file of paths. Throws Error(invalid_input) with the message "FILE:LINE:COLUMN: ...", or "FILE:
/// ..." if `path` is not a regular file.
[[nodiscard]] std::vector<ObjectPath> read_paths(const std::filesystem::path& path);

/// Returns the ids of the objects that each path moves: the ids that the path lists, and all ids with a name
/// that it lists. `names` contains the name of each id. Throws Error(invalid_input) "FILE:LINE: ..." for an
/// unknown id or name, and for an id that two paths move.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> resolve_ids(
    const std::vector<ObjectPath>& paths, const std::map<std::uint32_t, std::string>& names);

/// Returns the motion of the sample file's objects. For objects in `paths`, the motion of the path replaces
/// the file's motion. Throws the same errors as resolve_ids.
[[nodiscard]] FrameMotion motion_of(const SampleHeader& header, const std::vector<ObjectPath>& paths);

}  // namespace postlens
