// The cause of each pixel's error, from the records, the lens and the shutter.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

enum class ErrorCause : std::uint8_t {
    none,            ///< the pixel is not wrong
    hidden_surface,  ///< the lens sees a surface that is not recorded
    visibility,      ///< the method mixes recorded surfaces of which one hides the other
    curvature_of_w,  ///< nonlinear W: a reflected or refracted node is reprojected to a wrong position
    view_dependent_shading,     ///< no other cause: the radiance differs over the lens
    path_and_depth_correlated,  ///< an object moves through the focus or in front of a blurred object
    frame_edge,                 ///< light comes from beyond the overscan
    kernel_truncation,          ///< the number of depths or the size of kernels was limited
    record_density,             ///< edges are known to a quadtree cell only, or there are too few views
};
inline constexpr std::size_t error_causes = 9;
/// Name of a cause, such as "hidden-surface".
[[nodiscard]] std::string_view cause_name(ErrorCause cause);

struct CauseRequest {
    HybridSettings view;                ///< lens, shutter and motion; the method is ignored
    std::optional<FocusMethod> method;  ///< method that made the image; empty: unknown
    std::optional<int> depths;          ///< number of depths that `scatter` was limited to
    /// A pixel is wrong if a channel differs by more than this, sRGB values.
    double wrong_above = 1.0 / 255;
};

struct CauseMap {
    int width = 0, height = 0;
    std::vector<ErrorCause> causes;                  ///< per pixel
    std::array<double, error_causes> error_share{};  ///< per cause, share of the wrong pixels' squared error
};

/// Finds the cause of the error of each wrong pixel (CauseRequest::wrong_above), in three steps.
///
/// 1. Some causes can be removed: the image is made again with finer kernels (kernel_truncation), and by the
///    light field with many views. The latter removes visibility, path_and_depth_correlated with an open
///    shutter, record_density of a light field with fewer views, and curvature_of_w if another depth model
///    than W was used. A pixel whose error falls to half or less has that cause.
/// 2. With `view.scene`, if a tenth of the error is still unexplained, the scene is traced again, without
///    limits that may be the cause (error_trials).
/// 3. For pixels that are still unexplained, an error is estimated for each remaining cause: for hidden
///    surfaces and light from beyond the overscan from the local contrast, for nonlinear W from the radiance
///    that it moves, and for the record density from the record floor (record_floor). The cause with the
///    largest estimate is chosen if that is at least a tenth of the error. Otherwise the cause is
///    view-dependent shading.
///
/// Throws what hybrid_picture throws. The images' size must be the file's.
[[nodiscard]] CauseMap find_error_causes(FocusFrame& frame, const Image& image, const Image& reference,
                                         const CauseRequest& request);

}  // namespace postlens
