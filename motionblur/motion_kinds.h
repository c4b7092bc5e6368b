// How each object moves on the raster while the shutter is open: not at all, as a whole, each part by its
// depth, or otherwise.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/sample_file.h"
#include "reproject/raster_map.h"

namespace postlens {

/// The box around an id's recorded surfaces: raster px and inverse depth, 1/m.
struct IdExtent {
    std::uint64_t records = 0;
    double x_min = 0, x_max = 0, y_min = 0, y_max = 0, inverse_z_min = 0, inverse_z_max = 0;
    double inverse_z_sum = 0;
    void add(double x, double y, double inverse_z);
    void add(const IdExtent& o);
    [[nodiscard]] RasterPoint centre() const;
};
using IdExtents = std::map<std::uint32_t, IdExtent>;

/// Adds the primary nodes of all layers of a band. `only`: sorted ids to look at; empty: all. False where the
/// band has none of them.
bool add_extents(const RecordBand& band, const std::vector<std::uint32_t>& only, IdExtents& to);

enum class MotionKind {
    still,        ///< within 0.01 px of where it was recorded
    translation,  ///< every point moves as the middle does, within 0.25 px: parallel to the film
    parallax,     ///< parallel to the film as well, but of some depth: every point moves as the middle does,
                  ///< times its inverse depth over the middle's, within 0.25 px
    general       ///< turns, comes closer, or passes the camera
};

struct IdMotion {
    std::uint32_t id = 0;
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0;  ///< of a corner of the box, from the instant of the records; may be infinite
    double deviation_px = 0;     ///< of a corner's movement from the middle's; may be infinite
    double bend_px = 0;  ///< of a corner's movement from the middle's at the corner's depth; may be infinite
    RasterPoint centre;
    double inverse_z = 0;  ///< mean of its records, 1/m
};

/// Those that do not stand still, in the order of `ids`.
[[nodiscard]] std::vector<std::uint32_t> moving_ids(const std::vector<IdMotion>& ids);

/// The name of an id; "background" for 0, empty where the file has none.
[[nodiscard]] std::string name_of(const SampleHeader& header, std::uint32_t id);
/// The same for messages: the number where there is no name.
[[nodiscard]] std::string label_of(const SampleHeader& header, std::uint32_t id);

struct Exposure {
    double open_s = 0, close_s = 0;
};

inline constexpr double still_px = 0.01;
inline constexpr double translation_px = 0.25;

/// Looks at the box's corners and middle at the breaks of the motion and at evenly spaced instants.
[[nodiscard]] IdMotion classify(const FrameMotion& motion, std::uint32_t id, const IdExtent& extent,
                                double recorded_s, const Exposure& exposure);

/// Instants at which motions are compared: open, close, evenly between, and the breaks that lie there.
[[nodiscard]] std::vector<double> probe_times(const std::vector<double>& breaks_s, const Exposure& exposure);

}  // namespace postlens
