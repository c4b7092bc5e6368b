// Things so narrow on the film that the corners of pixels may miss them: hairs, wires, distant lamps. The
// scene knows where they are, so cells there are divided until a corner must hit them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <set>
#include <vector>

#include "tracer/camera_model.h"
#include "tracer/scene.h"

namespace postlens {

/// What is seen directly of them; mirrors and glass may show others. Planes and meshes that are wider
/// somewhere are not among them.
class SmallThings {
  public:
    /// Wider than this, px, the corners of undivided pixels hit a thing.
    static constexpr double widest_px = 1.5;
    /// Cells are at most this share of a thing's width, so that a corner hits it wherever it lies ...
    static constexpr double find_share = 0.5;
    /// ... and along the outline of what is compact and brighter than white at most this: the area of a disc
    /// d px wide is then known to 1.2 % (Kendall 1948), and so is the brightness of the blurred disc that it
    /// becomes.
    static constexpr double bright_share = 0.0625;
    /// Cells are divided no deeper than this.
    static constexpr int most_levels = 7;
    /// So many cells for every pixel of the raster are spent at most: bright things first, then the wider
    /// ones.
    static constexpr double most_cells_per_pixel = 4;

    /// None at all, for who samples without a scene.
    SmallThings() = default;
    /// Those of the scene at an instant, around raster positions [x_begin, x_end] x [y_begin, y_end], px.
    SmallThings(const Scene& scene, const CameraModel& camera, double time_s, double x_begin, double x_end,
                double y_begin, double y_end);

    [[nodiscard]] bool empty() const { return pieces_.empty(); }
    /// Levels of subdivision that they ask for, at most `most_levels`; 0 without any.
    [[nodiscard]] int levels() const { return levels_; }
    /// About how many cells they ask for.
    [[nodiscard]] double cells() const;
    /// How many objects they belong to.
    [[nodiscard]] std::uint64_t objects() const;
    /// Objects that are too narrow or too many to be sought.
    [[nodiscard]] std::uint64_t lost() const { return lost_.size(); }

    /// How large a cell may be, px.
    struct Wanted {
        double find_px;     ///< wherever it lies near a thing
        double outline_px;  ///< where its corners differ
    };
    /// For the square of edge `size` px with its upper left at (x, y) that shows nothing farther away than
    /// `farthest_m`.
    [[nodiscard]] Wanted wanted(double x, double y, double size, double farthest_m) const;

  private:
    /// A straight piece of a thing on the film.
    struct Piece {
        glm::dvec2 from{0}, to{0};  ///< its axis, px
        double width = 0;           ///< where it is narrowest, px
        double reach = 0;           ///< all of it lies within so many px of the axis
        double nearest_m = 0;       ///< z'
        double find_px = 1, outline_px = 1;
        double brightness = 0;
        std::uint32_t object = 0;
        /// About how many cells it asks for.
        [[nodiscard]] double cells() const;
    };
    void add(const Object& object, std::uint32_t index, double brightness, const CameraModel& camera,
             double time_s);
    void add_piece(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& half,
                   double brightness, std::uint32_t object, const CameraModel& camera);
    void keep_affordable();
    void index_tiles();

    double x_begin_ = 0, x_end_ = 0, y_begin_ = 0, y_end_ = 0;
    int columns_ = 0, rows_ = 0, levels_ = 0;
    std::vector<Piece> pieces_;
    std::set<std::uint32_t> lost_;
    std::vector<std::uint32_t> tile_offsets_, tile_pieces_;
};

}  // namespace postlens
