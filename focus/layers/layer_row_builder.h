// Converts the samples of one row to splats. A splat is a sample with the blur kernel that spreads its light
// over the image.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <vector>

#include "focus/layers/layer_splats.h"
#include "focus/responses/kernel.h"
#include "focus/responses/node_response.h"
#include "focus/scatter/pixel_light.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Builds the splats (samples with their blur kernels) of the image, one row of samples at a time. Each
/// thread needs its own builder.
class LayerSplats::RowBuilder {
  public:
    explicit RowBuilder(LayerSplats& splats) : t_(splats), cache_(splats.kernels_) {}

    void build(const RecordBand& band, const PointSamples& samples, std::size_t first_pixel, int y);
    void build(std::span<const PixelLight> lights, int y);

  private:
    void begin_row(int y);
    void end_row();
    void add_light(const PixelLight& light);
    /// The surface points that an eye ray through the raster position (x, y), in px, reaches: a surface on
    /// the ray, and what this surface reflects and transmits. One ray may have several such groups, because
    /// surfaces that are hidden from the pinhole are recorded, too.
    struct Nodes {
        float x, y;
        std::span<const Record> records;
    };
    /// A surface point that the current eye ray hits, directly or by reflections and refractions.
    struct Met {
        const Record* node = nullptr;
        NodeResponse response;
        std::array<float, 3> subtree{};  ///< radiance of the node and its descendants
        LayerPart part{};                ///< the part that it was added to
    };

    void find_hidden(const RecordBand& band, std::size_t pixel);
    void add_sample(const PointSample& s, std::span<const Record> nodes, std::span<const Nodes> hidden);
    void meet(std::span<const Record> nodes, const NodeResponse& primary);
    void add_tree(const PointSample& s, std::span<const Record> nodes, LayerPart::Kind kind);
    void add_hidden_chains(const PointSample& s, std::span<const Record> nodes, const NodeResponse& primary,
                           SurfaceKey surface);
    [[nodiscard]] const Met* met_at(NodePath path) const;
    [[nodiscard]] const Met& outline_of(const Met& from) const;
    /// Adds a sample to a mask, which tells how much of each pixel shows a certain object in a mirror or
    /// through glass. The mask ends where the mirror or glass ends, so the sample is blurred like it.
    /// - `from`: point of the mirror or glass
    /// - `met`: point of the object that is seen there
    void add_mask(const PointSample& s, const Met& from, const Met& met);
    void add_node(const PointSample& s, const NodeResponse& response, const Record& node,
                  const std::array<float, 3>& rgb, const LayerPart& part);
    void place(const PointSample& s, const NodeResponse& response, const std::array<float, 3>& rgb,
               float weight, double inverse_depth, const LayerPart& part);
    void add(const LayerSplat& splat, std::uint32_t number, std::size_t hash);
    [[nodiscard]] std::uint32_t number_of(const LayerPart& part);

    struct Shown {
        std::uint32_t path, id;
        double radius_px;
    };
    struct Slot {
        std::uint64_t key = 0;
        std::size_t index = 0;  ///< index of a splat in the row
    };

    LayerSplats& t_;
    KernelNumberCache cache_;
    UnsortedRow row_;
    std::map<LayerPart, std::uint32_t> number_;
    LayerPart last_part_;  ///< cache: most samples have the same part as the sample before
    std::uint32_t last_number_ = ~std::uint32_t{0};
    glm::dvec2 place_px_{0};  ///< position of the sample, from the image's centre
    int y_ = 0;
    bool alone_ = true;            ///< the pixel has no other sample
    std::size_t pixel_begin_ = 0;  ///< the pixel's first splat
    std::vector<Slot> slots_{1024};
    std::vector<Nodes> hidden_;       ///< hidden layers of the pixel, by position and layer
    std::vector<Met> met_;            ///< nodes of the current tree
    float covered_ = 0;               ///< LayerSplat::covered of the current node, divided by its weight
    std::vector<double> radii_px_;    ///< signed CoC radii of the sample's surfaces so far
    std::vector<std::uint32_t> ids_;  ///< ids of the sample's surfaces so far
    std::vector<Shown> shown_;        ///< reflected and transmitted nodes of the sample so far
};

}  // namespace postlens
