// Reads PATHS.toml, which contains paths of moving objects (docs/motion_paths.md).
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

/// Largest accepted size of a paths file, in bytes.
inline constexpr std::uintmax_t largest_paths_bytes = 256'000'000;

/// Keyframes of a rigid motion in scene coordinates, in m. There is at least one, and times increase.
using RigidKeys = std::vector<TransformKey>;

/// An entry of a file of motion paths: a motion (`motion`), and the objects that it moves, given by their ids
/// (`ids`) and names (`objects`). At each instant, an object is displaced by the motion's position at this
/// instant minus its position at the frame's time.
struct ObjectPath {
    std::vector<std::uint32_t> ids;    ///< each is at least 1 and occurs once
    std::vector<std::string> objects;  ///< names in the sample file
    std::string source;                ///< "FILE:LINE" of the [[path]]
    std::variant<ScreenPath, RigidKeys> motion;
};

/// Reads a file that defines motion paths of objects. Throws Error(invalid_input) "FILE:LINE:COLUMN: ...", or
/// "FILE: ..." if `path` is not a regular file.
[[nodiscard]] std::vector<ObjectPath> read_paths(const std::filesystem::path& path);

/// For each motion path, returns the ids of the objects that it moves. `names` contains the name of each id.
///
/// Throws Error(invalid_input) "FILE:LINE: ..." for an unknown id or name, and for an id that two paths move.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> resolve_ids(
    const std::vector<ObjectPath>& paths, const std::map<std::uint32_t, std::string>& names);

/// Returns how the objects of the sample file move. For an object in `paths`, this replaces the motion that
/// the file records. Throws the errors of resolve_ids.
[[nodiscard]] FrameMotion motion_of(const SampleHeader& header, const std::vector<ObjectPath>& paths);

}  // namespace postlens
