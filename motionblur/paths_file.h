// PATHS.toml, docs/motion_paths.md: the paths of moving things, given instead of those of the sample file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "motionblur/screen_path.h"
#include "records/transform_key.h"
#include "reproject/raster_map.h"

namespace postlens {

/// A larger file is refused before it is read.
inline constexpr std::uintmax_t largest_paths_bytes = 256'000'000;

/// Rigid motion in the scene's metres; at least one key, times grow.
using RigidKeys = std::vector<TransformKey>;

/// What moves, and how. Only differences count: at a time t a thing is moved by r'(t) - r'(time of the
/// frame).
struct ObjectPath {
    std::vector<std::uint32_t> ids;    ///< 1 or more each, none twice
    std::vector<std::string> objects;  ///< names in the sample file
    std::string source;                ///< "FILE:LINE" of the [[path]]
    std::variant<ScreenPath, RigidKeys> motion;
};

/// Throws Error(invalid_input) "FILE:LINE:COLUMN: ...", for what is no file "FILE: ...".
[[nodiscard]] std::vector<ObjectPath> read_paths(const std::filesystem::path& path);

/// The ids of each path, in the order of `paths`: its own and those of all ids that have its names. Throws
/// Error(invalid_input) "FILE:LINE: ..." for an id or a name that `names` (name by id) does not have and for
/// an id that two paths move.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> resolve_ids(
    const std::vector<ObjectPath>& paths, const std::map<std::uint32_t, std::string>& names);

/// The motion of the file's objects, with these paths in place of what it says of theirs. Throws as
/// resolve_ids.
[[nodiscard]] FrameMotion motion_of(const SampleHeader& header, const std::vector<ObjectPath>& paths);

}  // namespace postlens
