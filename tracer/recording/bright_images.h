// Finds quadtree cells in which mirrors or glass may show a small bright object, so that these cells are
// subdivided. Rays at pixel corners may miss such an object.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// Largest sizes of quadtree cells, px, that suffice for narrow objects.
struct WantedCells {
    double find_px;     ///< for every cell near a narrow object
    double outline_px;  ///< for cells whose corners have different ids
    [[nodiscard]] bool divide(double size_px, bool different_ids) const {
        return size_px > find_px || (different_ids && size_px > outline_px);
    }
};

/// The compact objects of a scene that are brighter than white, such as small light sources. Mirrors and
/// glass may show small images of them. `wanted` finds the quadtree cells that may contain such an image and
/// must therefore be divided.
class BrightImages {
  public:
    /// Greatest depth of the subdivision.
    static constexpr int most_levels = 5;
    /// Approximate number of quadtree cells that one image of a bright object in a mirror or in glass needs.
    /// Eye rays through the corners of these cells record the image.
    static constexpr double cells_of_image = 200;

    /// Contains no objects.
    BrightImages() = default;
    /// Collects the bright objects of the scene at the instant `time_s`. Later, their images in mirrors and
    /// glass are searched for, and pixels that contain such an image are divided into many quadtree cells. If
    /// all images together may need more than `most_cells` cells, only the objects that emit the most light
    /// are kept.
    BrightImages(const Scene& scene, double time_s, double most_cells);

    [[nodiscard]] bool empty() const { return spheres_.empty(); }
    /// Returns how small the parts of a given quadtree cell must be to record the images of bright objects in
    /// mirrors and glass. The cell contains such an image if a bright object lies in the space between four
    /// rays: those that arrive, after the same bounces, from the cell's corners. If it contains none, the
    /// result is infinity, i.e. no limit.
    /// - `at`: these four rays, row by row
    /// - `size_px`: width of the given cell, px
    [[nodiscard]] WantedCells wanted(const std::array<const Arrival*, 4>& at, double size_px) const;

  private:
    struct Sphere {
        glm::dvec3 centre{0};
        double radius = 0, brightness = 0;
    };
    /// A node of a bounding-sphere hierarchy, stored depth first. It encloses the elements [first, last) of
    /// `spheres_`.
    struct Group {
        glm::dvec3 centre{0};
        double radius = 0;
        std::uint32_t first = 0, last = 0;
        std::uint32_t after = 0;  ///< index of the first node that is not below this one
    };
    static constexpr std::uint32_t few = 4;  ///< largest number of spheres of a leaf
    void add_group(std::uint32_t first, std::uint32_t last);

    std::vector<Sphere> spheres_;
    std::vector<Group> groups_;
};

}  // namespace postlens
