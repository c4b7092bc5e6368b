// Finds objects so narrow in the image that rays at pixel corners may miss them, such as hairs.
// Quadtree cells near these objects are subdivided until a corner must hit them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <set>
#include <vector>

#include "scene/object_parts.h"
#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/recording/bright_images.h"
#include "tracer/recording/mesh_outlines.h"

namespace postlens {

/// Finds objects and connected mesh parts that are so narrow in the image that eye rays may miss them.
class SmallThings {
  public:
    /// Greatest width, px, of the objects for which the class searches. Eye rays pass through all corners of
    /// pixels, so a wider object is always hit by one of them. A narrower object may lie between them.
    static constexpr double widest_px = 1.5;
    /// Greatest width of a quadtree cell at a narrow object, as a fraction of the object's width. Pixels are
    /// divided into such cells, and eye rays pass through their corners. If cells are at most half as wide as
    /// the object, at least one corner lies on it, so that a ray hits it.
    static constexpr double find_share = 0.5;
    /// Greatest width of a quadtree cell at the outline of a compact bright object, as a fraction of the
    /// object's width. When the object is blurred, its brightness is proportional to its area on the raster.
    /// With cells of this width, the area of a disc, and so its brightness, has an error of 1.2 % (Kendall
    /// 1948).
    static constexpr double bright_share = 0.0625;
    /// Greatest depth of the subdivision.
    static constexpr int most_levels = 7;
    /// Limit of the number of quadtree cells, as an average per pixel, into which pixels are divided to find
    /// narrow objects (narrower than 1.5 px). If these objects need more cells in total, those that emit
    /// light brighter than white get their cells first. The remaining cells go to the other narrow objects,
    /// from the widest to the narrowest.
    static constexpr double most_cells_per_pixel = 4;

    /// Contains no narrow objects. Used to sample without a scene.
    SmallThings() = default;
    /// Finds the narrow objects of the scene, as seen by the camera at an instant. `parts` must belong to
    /// `scene`. Only raster positions in [x_begin, x_end] x [y_begin, y_end], px, are searched.
    SmallThings(const Scene& scene, const ObjectParts& parts, const CameraModel& camera, double time_s,
                int x_begin, int x_end, int y_begin, int y_end);

    [[nodiscard]] bool empty() const { return pieces_.empty(); }
    /// Bright objects seen in mirrors and glass.
    [[nodiscard]] const BrightImages& images() const { return images_; }
    /// Finds the outlines of meshes in the image. Pixels are divided into quadtree cells, and eye rays pass
    /// through the corners of cells. These rays may all miss an object whose outline crosses the cell, but
    /// with the outlines known, such a cell can be divided. The arguments must be the same as those of the
    /// constructor. Needs up to 160 bytes of memory per pixel.
    void find_outlines(const Scene& scene, const ObjectParts& parts, const CameraModel& camera,
                       double time_s);
    /// Empty before find_outlines().
    [[nodiscard]] const MeshOutlines& outlines() const { return outlines_; }
    /// Returns how often a pixel must be divided into quarters so that every narrow object (narrower than 1.5
    /// px) is found, i.e. hit by an eye ray through a corner of the resulting cells. The result is at most
    /// `most_levels`.
    [[nodiscard]] int levels() const { return levels_; }
    /// Returns the approximate number of cells that all narrow objects need.
    [[nodiscard]] double cells() const;
    /// Number of narrow objects.
    [[nodiscard]] std::uint64_t objects() const;
    /// Returns the number of narrow objects that are omitted, wholly or in part, because they are narrower
    /// than the smallest quadtree cells or because there are too many.
    [[nodiscard]] std::uint64_t lost() const { return lost_.size(); }

    /// Returns how small quadtree cells must be within a square of the image. Eye rays pass through the
    /// corners of these cells, and in cells of the returned size, a ray hits every object narrower than 1.5
    /// px.
    /// (x, y) is the square's upper left corner, and `size` its width, px.
    /// Objects farther away than `farthest_m` are ignored.
    [[nodiscard]] WantedCells wanted(double x, double y, double size, double farthest_m) const;

  private:
    /// A straight piece of a narrow object, projected to the film.
    struct Piece {
        glm::dvec2 from{0}, to{0};  ///< its axis, px
        double width = 0;           ///< perpendicular to its longest direction, px
        double reach = 0;           ///< greatest distance of its points from the axis, px
        double nearest_m = 0;       ///< least z' of its points, m
        double find_px = 1, outline_px = 1;
        double brightness = 0;
        std::uint32_t object = 0;
        /// Approximate number of cells that this piece needs.
        [[nodiscard]] double cells() const;
    };
    void add_piece(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& half,
                   double brightness, std::uint32_t object, const CameraModel& camera);
    [[nodiscard]] double raster_px() const {
        return std::max(0.0, x_end_ - x_begin_) * std::max(0.0, y_end_ - y_begin_);
    }
    void keep_affordable();
    void index_tiles();

    double x_begin_ = 0, x_end_ = 0, y_begin_ = 0, y_end_ = 0;
    int columns_ = 0, rows_ = 0, levels_ = 0;
    double affordable_px_ = 0;  ///< narrower pieces are not kept, unless they are bright
    std::vector<Piece> pieces_;
    BrightImages images_;
    MeshOutlines outlines_;
    std::set<std::uint32_t> lost_;
    std::vector<std::uint32_t> tile_offsets_, tile_pieces_;
};

}  // namespace postlens
