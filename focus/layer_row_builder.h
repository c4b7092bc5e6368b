// One row of a sample file turned into splats surface by surface: what LayerSplats is made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <vector>

#include "focus/kernel.h"
#include "focus/layer_splats.h"
#include "focus/node_response.h"
#include "focus/pixel_light.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Takes in one row of corners; everything it writes belongs to that row alone.
class LayerSplats::RowBuilder {
  public:
    explicit RowBuilder(LayerSplats& splats) : t_(splats), cache_(splats.kernels_) {}

    void build(const RecordBand& band, const PointSamples& samples, std::size_t first_pixel, int y);
    void build(std::span<const PixelLight> lights, int y);

  private:
    void begin_row(int y);
    void end_row();
    void add_light(const PixelLight& light);
    /// Nodes of one layer at one place.
    struct Nodes {
        float x, y;
        std::span<const Record> records;
    };
    /// A node with what it needs to stand as a parent.
    struct Met {
        const Record* node = nullptr;
        NodeResponse response;
        std::array<float, 3> subtree{};  ///< colour of the node and all that go on from it
        LayerPart part{};                ///< where it was placed
    };

    void find_hidden(const RecordBand& band, std::size_t pixel);
    void add_sample(const PointSample& s, std::span<const Record> nodes, std::span<const Nodes> hidden);
    void meet(std::span<const Record> nodes, const NodeResponse& primary);
    void add_tree(const PointSample& s, std::span<const Record> nodes, LayerPart::Kind kind);
    void add_hidden_chains(const PointSample& s, std::span<const Record> nodes, const NodeResponse& primary,
                           SurfaceKey surface);
    /// Of the tree at hand; null: it has none.
    [[nodiscard]] const Met* met_at(NodePath path) const;
    /// What has the outline of `from`, the node that a chain goes on from.
    [[nodiscard]] const Met& outline_of(const Met& from) const;
    /// Of the chain that ends at `met` and goes on from `from`, which was placed.
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
        std::size_t index = 0;  ///< of the row's splats
    };

    LayerSplats& t_;
    KernelNumberCache cache_;
    Row row_;
    std::map<LayerPart, std::uint32_t> number_;
    LayerPart last_part_;  ///< most samples go where the one before went
    std::uint32_t last_number_ = ~std::uint32_t{0};
    glm::dvec2 place_px_{0};  ///< of the sample, from the picture's middle
    int y_ = 0;
    bool alone_ = true;            ///< the pixel has no other sample
    std::size_t pixel_begin_ = 0;  ///< the pixel's first splat
    std::vector<Slot> slots_{1024};
    std::vector<Nodes> hidden_;       ///< of the pixel, by place and layer
    std::vector<Met> met_;            ///< of the tree at hand
    float covered_ = 0;               ///< share of what is being placed
    std::vector<double> radii_px_;    ///< signed, of the surfaces met so far
    std::vector<std::uint32_t> ids_;  ///< of the surfaces met so far
    std::vector<Shown> shown_;        ///< by chains, so far
};

}  // namespace postlens
