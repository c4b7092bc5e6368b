// Classifies how each object moves on the raster while the shutter is open. Either it does not move, or it
// moves as a whole, or each part moves in proportion to its inverse depth, or the motion is general.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/sample_file.h"
#include "reproject/raster_map.h"

namespace postlens {

/// Bounding box of the recorded surfaces of one object (id): raster px and inverse depth, 1/m.
struct IdExtent {
    std::uint64_t records = 0;
    double x_min = 0, x_max = 0, y_min = 0, y_max = 0, inverse_z_min = 0, inverse_z_max = 0;
    double inverse_z_sum = 0;
    void add(double x, double y, double inverse_z);
    void add(const IdExtent& o);
    [[nodiscard]] RasterPoint centre() const;
};
using IdExtents = std::map<std::uint32_t, IdExtent>;

/// Enlarges the bounding boxes of objects to include the directly visible surfaces of all layers of a band.
/// `only`: sorted ids of the objects to include; empty for all objects. Returns whether the band contains any
/// of these objects.
bool add_extents(const RecordBand& band, const std::vector<std::uint32_t>& only, IdExtents& to);

enum class MotionKind {
    still,        ///< stays within 0.01 px of its recorded position
    translation,  ///< parallel to the film: every point moves like the box's centre, within 0.25 px
    parallax,     ///< parallel to the film, with depth: every point moves like the box's centre, times the
                  ///< ratio of its inverse depth to the centre's, within 0.25 px
    general       ///< rotates, approaches, or passes the camera
};

struct IdMotion {
    std::uint32_t id = 0;
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0;  ///< largest displacement of a corner of the box; may be infinite
    /// Largest difference between the displacements of a corner of the box and of the box's centre; may be
    /// infinite.
    double deviation_px = 0;
    /// The same difference after the centre's displacement has been scaled to the corner's inverse depth
    /// (parallax).
    double bend_px = 0;
    RasterPoint centre;
    double inverse_z = 0;  ///< mean of its records, 1/m
};

/// Ids of the objects that move, in the order of `ids`.
[[nodiscard]] std::vector<std::uint32_t> moving_ids(const std::vector<IdMotion>& ids);

/// Name of an id: "background" for id 0; empty if the file has no name for it.
[[nodiscard]] std::string name_of(const SampleHeader& header, std::uint32_t id);
/// Name of an id in messages. If the id has no name, it is the id's number.
[[nodiscard]] std::string label_of(const SampleHeader& header, std::uint32_t id);

struct Exposure {
    double open_s = 0, close_s = 0;
};

inline constexpr double still_px = 0.01;
inline constexpr double translation_px = 0.25;

/// Classifies the motion of an object. The displacements of its bounding box's corners and centre are
/// compared at uniformly spaced instants and at the instants where the object's velocity may change abruptly.
[[nodiscard]] IdMotion classify(const FrameMotion& motion, std::uint32_t id, const IdExtent& extent,
                                double recorded_s, const Exposure& exposure);

/// Instants at which motions are compared: the opening, the closing, uniformly spaced instants between them,
/// and those of `breaks_s` between them.
[[nodiscard]] std::vector<double> probe_times(const std::vector<double>& breaks_s, const Exposure& exposure);

}  // namespace postlens
