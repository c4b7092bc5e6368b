// Classifies how each object moves on the raster during the exposure.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/sample_file.h"
#include "reproject/raster_map.h"

namespace postlens {

/// Bounding box of one object's recorded surfaces, in raster px and inverse depths (1/m).
struct IdExtent {
    std::uint64_t records = 0;
    double x_min = 0, x_max = 0, y_min = 0, y_max = 0, inverse_z_min = 0, inverse_z_max = 0;
    double inverse_z_sum = 0;
    void add(double x, double y, double inverse_z);
    void add(const IdExtent& o);
    [[nodiscard]] RasterPoint centre() const;
};
using IdExtents = std::map<std::uint32_t, IdExtent>;

/// Enlarges the bounding boxes `to` of objects in the image, so that they include all directly visible
/// samples in a band of pixel rows. If `only` (sorted ids) is not empty, all other objects are ignored.
/// Returns true if the band contains such a sample.
bool add_extents(const RecordBand& band, const std::vector<std::uint32_t>& only, IdExtents& to);

enum class MotionKind {
    still,        ///< stays within 0.01 px of its recorded position
    translation,  ///< parallel to the film: within 0.25 px, every point moves like the box's centre
    /// Moves parallel to the film, but near points of the object move visibly farther in the image than its
    /// distant points. The displacement of each corner of the object's bounding box is proportional to its
    /// inverse depth, with an error of at most 0.25 px.
    parallax,
    general  ///< rotates, approaches, or passes the camera
};

struct IdMotion {
    std::uint32_t id = 0;
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0;  ///< largest displacement of a corner of the box; may be infinite
    double path_px = 0;          ///< length of the longest path of a corner of the box; may be infinite
    /// How differently the parts of the object move in the image: the largest difference, in px, between the
    /// displacement of a corner of the object's bounding box and that of the box's centre. It is infinite if
    /// the box passes the camera.
    double deviation_px = 0;
    /// How much the object's motion differs from pure parallax, i.e. displacements proportional to inverse
    /// depth. It is the largest error, in px, of predicting the displacement of a corner of the object's
    /// bounding box from the displacement of the box's centre.
    double bend_px = 0;
    RasterPoint centre;
    double inverse_z = 0;  ///< mean inverse depth of the object's recorded samples, 1/m
};

/// Returns the ids of the objects that move, in the order of `ids`.
[[nodiscard]] std::vector<std::uint32_t> moving_ids(const std::vector<IdMotion>& ids);

/// Returns the name of the object `id`. If the file states no name, this is "background" for id 0, and empty
/// for all other ids.
[[nodiscard]] std::string name_of(const SampleHeader& header, std::uint32_t id);
/// Returns an id's name for messages, or its number if it has none.
[[nodiscard]] std::string label_of(const SampleHeader& header, std::uint32_t id);

struct Exposure {
    double open_s = 0, close_s = 0;
};

inline constexpr double still_px = 0.01;
inline constexpr double translation_px = 0.25;

/// Classifies how an object moves in the image (MotionKind). For this, the displacement of each corner of its
/// bounding box is compared with that of the box's centre, at the instants that probe_times returns.
[[nodiscard]] IdMotion classify(const FrameMotion& motion, std::uint32_t id, const IdExtent& extent,
                                double recorded_s, const Exposure& exposure);

/// Returns the instants at which the displacements of objects are evaluated to classify their motion. Some of
/// them divide the exposure into uniform steps. The others are the instants of `breaks_s` within the
/// exposure, at which the velocity of an object may change abruptly.
[[nodiscard]] std::vector<double> probe_times(const std::vector<double>& breaks_s, const Exposure& exposure);

}  // namespace postlens
