// Finds the outlines of meshes in the image. If an outline crosses a quadtree cell, rays through the cell's
// corners may miss a part of the mesh, such as the tip of a leaf.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/object_parts.h"
#include "scene/scene.h"
#include "tracer/camera_model.h"

namespace postlens {

/// The outlines of meshes in the image: edges that belong to only one triangle, and edges between
/// a triangle that faces the camera and one that faces away.
class MeshOutlines {
  public:
    /// Largest average number of mesh edges per pixel that are kept as outlines. If there are more, those
    /// farthest from the camera are omitted.
    static constexpr double most_per_pixel = 4;

    MeshOutlines() = default;
    /// Finds the outlines of the scene's meshes, as seen by the camera at an instant. `parts` must belong to
    /// `scene`. Only raster positions in [x_begin, x_end] x [y_begin, y_end], px, are searched.
    MeshOutlines(const Scene& scene, const ObjectParts& parts, const CameraModel& camera, double time_s,
                 int x_begin, int x_end, int y_begin, int y_end);

    [[nodiscard]] bool empty() const { return crossings_.empty(); }

    /// The part of an object that is visible at all four corners of a quadtree cell.
    struct Shown {
        std::uint32_t id = 0, part = 0;
        std::array<float, 4> z_m{};  ///< z' at the upper left, upper right, lower left and lower right corner
    };
    /// Tests a square of the image whose corners all show the same part of an object, `shown`. Returns true
    /// if the outline of another, nearer part crosses the square. The square must lie within one pixel. Its
    /// upper left corner is (x, y), and `size` is its width, all in px.
    [[nodiscard]] bool cross(double x, double y, double size, const Shown& shown) const;

  private:
    /// The part of an edge that is inside the raster.
    struct Edge {
        glm::vec2 from{0}, to{0};                  ///< px
        float from_nearness = 0, to_nearness = 0;  ///< nearness() of the ends
        std::uint32_t id = 0, part = 0;
    };
    /// An edge that crosses a pixel of a row.
    struct Crossing {
        std::int32_t x = 0;
        std::uint32_t edge = 0;
    };
    void add_mesh(const Object& object, const Mesh& mesh, std::size_t index, const ObjectParts& parts,
                  const CameraModel& camera, double time_s);
    void index_rows();
    /// Returns a measure of how near a point at the depth `z_m` is to the camera. It is the inverse depth,
    /// 1/m, or, for an orthographic camera, minus the depth, m. Within a plane, this measure is a linear
    /// function of the raster position, so it can be interpolated along an edge.
    [[nodiscard]] double nearness(double z_m) const { return orthographic_ ? -z_m : 1 / z_m; }
    template <typename Take>
    void each_pixel(const Edge& edge, const Take& take) const;

    bool orthographic_ = false;
    int x_begin_ = 0, x_end_ = 0, y_begin_ = 0, y_end_ = 0;
    std::vector<Edge> edges_;
    std::vector<Crossing> crossings_;     ///< by row, and then by column
    std::vector<std::size_t> row_begin_;  ///< where each row begins, and where the last one ends
};

}  // namespace postlens
