// The mean of many views of the recorded surfaces, each from its own lens point or at its own instant.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "records/image.h"
#include "reproject/raster_map.h"
#include "reproject/sample_mesh.h"

namespace postlens {

/// One view: up to two recorded instants, each moved to where the view is, and blended.
struct FieldView {
    glm::dvec2 sample{0.5, 0.5};  ///< where in every pixel it looks, px
    double weight = 1;
    struct Use {
        std::size_t mesh = 0;
        double share = 1;             ///< of the colour where both meshes show the same surface
        std::vector<RasterMap> maps;  ///< by motion class; not read for meshes with velocities
        double elapsed = 0;           ///< since the mesh's instant, for meshes with velocities
    };
    std::vector<Use> uses;  ///< one or two
};

struct LightField {
    std::vector<const SampleMesh*> meshes;
    std::size_t motion_classes = 1;
    /// The motion class of an id: what moves alike shares one.
    std::function<std::size_t(std::uint32_t id)> motion_class;
    /// By class: bits that tell the user where what moves was seen. 0 for what stands still in every view.
    std::vector<std::uint8_t> class_marks;
    std::uint8_t wanted_marks = 0xFF;  ///< pixels that none of these can touch are not computed
    /// The views; those that share `sample` and meshes should be many, as what stands still is drawn once
    /// for them.
    std::vector<FieldView> views;
    int width = 0, height = 0;
    /// Only the tiles that have something of it are drawn; the others are left as recorded.
    std::optional<Crop> crop;
};

struct FieldPicture {
    Image image;  ///< pixels not `touched` are left black
    /// The marks of all that moves and is seen there in a view, or was recorded there; all bits where a view
    /// sees nothing known. 0: the pixel is as recorded.
    std::vector<std::uint8_t> touched;
    std::vector<float> unknown;  ///< share of the views' weight in which no surface is known there
};

/// Same bits for any number of threads.
[[nodiscard]] FieldPicture light_field(const LightField& field);

/// Puts what the views show into `image`, of the same size, in the pixels touched by one of `marks`. Where
/// part of a pixel is unknown, `behind` stands in for that part; it may be empty where nothing is.
void lay_over(Image& image, const FieldPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
