// Which impulse response a node of a shading tree has.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <memory>

#include "focus/depth_levels.h"
#include "focus/kernel.h"
#include "focus/phases.h"
#include "focus/response_model.h"
#include "records/record.h"

namespace postlens {

/// Half-open rectangle of whole coordinates, raster px.
struct RasterWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    [[nodiscard]] int width() const { return x_end - x_begin; }
    [[nodiscard]] int height() const { return y_end - y_begin; }
};

[[nodiscard]] inline bool meet(const RasterWindow& a, const RasterWindow& b) {
    return a.x_begin < b.x_end && b.x_begin < a.x_end && a.y_begin < b.y_end && b.y_begin < a.y_end;
}
[[nodiscard]] inline RasterWindow common(const RasterWindow& a, const RasterWindow& b) {
    return {std::max(a.x_begin, b.x_begin), std::min(a.x_end, b.x_end), std::max(a.y_begin, b.y_begin),
            std::min(a.y_end, b.y_end)};
}
/// The least that holds both.
[[nodiscard]] inline RasterWindow around(const RasterWindow& a, const RasterWindow& b) {
    return {std::min(a.x_begin, b.x_begin), std::max(a.x_end, b.x_end), std::min(a.y_begin, b.y_begin),
            std::max(a.y_end, b.y_end)};
}

/// From the middle of a window to a place of the raster, px.
[[nodiscard]] inline glm::dvec2 from_middle_px(const RasterWindow& window, float x, float y) {
    return {static_cast<double>(x) - (window.x_begin + window.x_end) / 2.0,
            static_cast<double>(y) - (window.y_begin + window.y_end) / 2.0};
}

/// A node's response: its key without phase, and its size.
struct NodeResponse {
    KernelKey key;
    double radius_px = 0;        ///< of the kernel: half the longer side of its bounding box
    double exact_radius_px = 0;  ///< of the CoC itself
    /// What it is made for, 1/m: not the node's own depth, but its level's. Only where it changes over the
    /// field.
    double inverse_depth_per_m = 0;
};

/// Responses of one lens setting. Places are counted from the middle of the picture.
class NodeResponses {
  public:
    NodeResponses(const FocusGeometry& geometry, DepthLevels levels, DepthModel model,
                  std::shared_ptr<const ResponseModel> response)
        : geometry_(geometry), levels_(std::move(levels)), model_(model), response_(std::move(response)) {}

    [[nodiscard]] NodeResponse to_depth(double inverse_depth_per_m, const glm::dvec2& place_px) const;
    /// Of a deeper node, as the depth model has it.
    [[nodiscard]] NodeResponse of(const Record& node, const NodeResponse& primary,
                                  const glm::dvec2& place_px) const;
    /// Share of the light that the lens lets through. 1 where one kernel serves the whole picture.
    [[nodiscard]] float passing(const NodeResponse& response, const glm::dvec2& place_px) const;
    /// Whether the weights spread as the light does; else by `whole`.
    [[nodiscard]] bool weighs_as_it_shines(const NodeResponse& response) const {
        return response.key.cell_log2 == 0 || model().weighs_as_it_shines();
    }
    /// As if nothing were lost.
    [[nodiscard]] static NodeResponse whole(NodeResponse response);
    /// Where a sample's response is placed.
    [[nodiscard]] Phases phases(const PointSample& sample, const NodeResponse& response) const;

    [[nodiscard]] const FocusGeometry& geometry() const { return geometry_; }
    [[nodiscard]] const DepthLevels& levels() const { return levels_; }
    [[nodiscard]] const ResponseModel& model() const { return *response_; }

  private:
    [[nodiscard]] NodeResponse to_w(const Mat2& w, const glm::dvec2& place_px) const;
    void finish_other(NodeResponse& out, const glm::dmat2& map_px, const glm::dvec2& place_px) const;

    FocusGeometry geometry_;
    DepthLevels levels_;
    DepthModel model_;
    std::shared_ptr<const ResponseModel> response_;
};

/// 1/z' of a record: infinity has the inverse depth 0; a depth that is smaller than a float's least normal
/// number is none.
[[nodiscard]] inline double inverse_depth_per_m(const Record& node) {
    return 1 / std::max(static_cast<double>(node.z), 1e-37);
}

}  // namespace postlens
