// Classifies how each object moves on the raster while the shutter is open. An object may stand still, move
// as a whole, move in proportion to the inverse depth of its parts, or move in any other way.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/sample_file.h"
#include "reproject/raster_map.h"

namespace postlens {

/// Bounding box of the recorded surfaces of one object (id). Positions are in raster px, and inverse depths
/// in 1/m.
struct IdExtent {
    std::uint64_t records = 0;
    double x_min = 0, x_max = 0, y_min = 0, y_max = 0, inverse_z_min = 0, inverse_z_max = 0;
    double inverse_z_sum = 0;
    void add(double x, double y, double inverse_z);
    void add(const IdExtent& o);
    [[nodiscard]] RasterPoint centre() const;
};
using IdExtents = std::map<std::uint32_t, IdExtent>;

/// Enlarges the bounding boxes of objects to include their records in a band, except those seen by reflection
/// or transmission. `only` contains the sorted ids of the objects to include. If it is empty, all objects are
/// included. Returns whether the band contains any of these objects.
bool add_extents(const RecordBand& band, const std::vector<std::uint32_t>& only, IdExtents& to);

enum class MotionKind {
    still,        ///< stays within 0.01 px of its recorded position
    translation,  ///< parallel to the film: within 0.25 px, every point moves like the box's centre
    /// The object moves parallel to the film, and nearer points move farther: the displacement of each point
    /// is proportional to its inverse depth, with an error of at most 0.25 px.
    parallax,
    general  ///< rotates, approaches, or passes the camera
};

struct IdMotion {
    std::uint32_t id = 0;
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0;  ///< largest displacement of a corner of the box; may be infinite
    double path_px = 0;          ///< length of the longest path of a corner of the box; may be infinite
    /// Largest difference, in px, between the displacement of a corner of the box and that of its centre.
    /// Infinite if the box passes the camera.
    double deviation_px = 0;
    /// Largest difference, in px, between the displacement of a corner of the box and its prediction by
    /// parallax: the displacement of the box's centre, times the ratio of the corner's inverse depth to the
    /// centre's.
    double bend_px = 0;
    RasterPoint centre;
    double inverse_z = 0;  ///< mean inverse depth of the object's records, 1/m
};

/// Returns the ids of the objects that move, in the order of `ids`.
[[nodiscard]] std::vector<std::uint32_t> moving_ids(const std::vector<IdMotion>& ids);

/// Returns the name of an id. It is "background" for id 0, and empty if the file has no name for the id.
[[nodiscard]] std::string name_of(const SampleHeader& header, std::uint32_t id);
/// Returns the name of an id for messages. If the id has no name, its number is returned.
[[nodiscard]] std::string label_of(const SampleHeader& header, std::uint32_t id);

struct Exposure {
    double open_s = 0, close_s = 0;
};

inline constexpr double still_px = 0.01;
inline constexpr double translation_px = 0.25;

/// Classifies the motion of an object by comparing the displacements of the corners and the centre of its
/// bounding box. They are compared at uniformly spaced instants, and at instants at which the object's
/// velocity may change abruptly.
[[nodiscard]] IdMotion classify(const FrameMotion& motion, std::uint32_t id, const IdExtent& extent,
                                double recorded_s, const Exposure& exposure);

/// Returns the instants at which motions are compared: the opening and the closing of the shutter, uniformly
/// spaced instants between them, and all instants of `breaks_s` during the exposure.
[[nodiscard]] std::vector<double> probe_times(const std::vector<double>& breaks_s, const Exposure& exposure);

}  // namespace postlens
