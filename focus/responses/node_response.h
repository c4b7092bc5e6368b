// The impulse response of a node of a shading tree.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <memory>

#include "focus/responses/depth_levels.h"
#include "focus/responses/kernel.h"
#include "focus/responses/phases.h"
#include "focus/responses/response_model.h"
#include "records/record.h"

namespace postlens {

/// A half-open rectangle with integer coordinates, in raster px.
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
/// Returns the smallest window that contains both windows.
[[nodiscard]] inline RasterWindow around(const RasterWindow& a, const RasterWindow& b) {
    return {std::min(a.x_begin, b.x_begin), std::max(a.x_end, b.x_end), std::min(a.y_begin, b.y_begin),
            std::max(a.y_end, b.y_end)};
}

/// Returns the vector from the centre of a window to a raster position, in px.
[[nodiscard]] inline glm::dvec2 from_middle_px(const RasterWindow& window, float x, float y) {
    return {static_cast<double>(x) - (window.x_begin + window.x_end) / 2.0,
            static_cast<double>(y) - (window.y_begin + window.y_end) / 2.0};
}

/// Describes the blur kernel of a surface point by its size, and by the key that identifies it in the table
/// of kernels. The subpixel position in the key is set later, because one sample may be added to the image at
/// several positions.
struct NodeResponse {
    KernelKey key;
    double radius_px = 0;        ///< half the longer side of the kernel's bounding box
    double exact_radius_px = 0;  ///< CoC radius, not quantised
    double farthest_px = 0;      ///< largest distance that light reaches; only set by to_depth
    /// Inverse depth, in 1/m, for which the transmittance of the lens is computed. The transmittance depends
    /// on the depth only if there is vignetting, which also makes blur kernels vary over the image. If they
    /// do not vary, the transmittance is 1, and this number is not set.
    double inverse_depth_per_m = 0;
};

/// Finds the blur kernels of surface points for one setting of the lens. Positions in the image, `place_px`,
/// are relative to its centre, in px.
class NodeResponses {
  public:
    NodeResponses(const FocusGeometry& geometry, DepthLevels levels, DepthModel model,
                  std::shared_ptr<const ResponseModel> response)
        : geometry_(geometry), levels_(std::move(levels)), model_(model), response_(std::move(response)) {}

    [[nodiscard]] NodeResponse to_depth(double inverse_depth_per_m, const glm::dvec2& place_px) const;
    /// Returns the blur kernel of `node`, a surface point that is seen by reflection or refraction. The depth
    /// model (DepthModel) decides what determines the kernel's size: `primary`, the kernel of the directly
    /// visible surface, the length of the path to the node, or the node's matrix W.
    [[nodiscard]] NodeResponse of(const Record& node, const NodeResponse& primary,
                                  const glm::dvec2& place_px) const;
    /// Returns the fraction of a sample's light that the lens transmits: 1 without vignetting.
    [[nodiscard]] float passing(const NodeResponse& response, const glm::dvec2& place_px) const;
    /// Returns the fraction of the lens that vignetting leaves open at a pixel.
    [[nodiscard]] double open_share(const RasterWindow& window, int x, int y) const {
        const auto middle = [](int at) { return static_cast<float>(at) + 0.5F; };
        return response_->transmission(from_middle_px(window, middle(x), middle(y)),
                                       geometry().inverse_focus_per_m);
    }
    /// Returns the subpixel positions at which a sample's blur kernel is added to the image, with a weight
    /// for each. A sample may have several positions, because it lies at the corner of up to four quadtree
    /// cells and represents a part of each.
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

/// Returns the inverse depth, 1/z', of a recorded surface point, in 1/m. 0 means infinitely far. z' is the
/// path length along the optical axis, `node.z`, in m. Depths below 1e-37 m are clamped, to avoid an
/// overflow.
[[nodiscard]] inline double inverse_depth_per_m(const Record& node) {
    return 1 / std::max(static_cast<double>(node.z), 1e-37);
}

}  // namespace postlens
