// Finds why a pixel of an image is wrong, for example because a hidden surface was not recorded.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

enum class ErrorCause : std::uint8_t {
    none,            ///< the pixel is not in error
    hidden_surface,  ///< the lens sees a surface that is not recorded
    visibility,      ///< the method mixes two recorded surfaces although one hides the other
    curvature_of_w,  ///< nonlinear W: a reflected or refracted node is reprojected to a wrong position
    view_dependent_shading,     ///< the radiance differs over the lens; assumed if no other cause is found
    path_and_depth_correlated,  ///< an object moves through the focus or in front of a blurred object
    frame_edge,                 ///< light comes from beyond the overscan
    kernel_truncation,          ///< the number of depths or the size of kernels is limited
    record_density,             ///< edges are known only to a quadtree cell, or there are too few views
};
inline constexpr std::size_t error_causes = 9;
/// Returns the name of a cause, such as "hidden-surface".
[[nodiscard]] std::string_view cause_name(ErrorCause cause);

struct CauseRequest {
    HybridSettings view;                ///< lens, shutter and motion of the image; the method is ignored
    std::optional<FocusMethod> method;  ///< method that made the image; empty if unknown
    std::optional<int> depths;          ///< number of depths to which `scatter` was limited
};

struct CauseMap {
    int width = 0, height = 0;
    std::vector<ErrorCause> causes;                  ///< per pixel
    std::array<double, error_causes> error_share{};  ///< per cause, share of the squared error
};

/// Finds the cause of the error in each wrong pixel. A pixel is wrong if the sRGB value of some channel
/// differs from the reference by more than 1/255. There are three steps.
///
/// 1. The image is made again in ways that avoid some causes. A cause explains an error that at least halves
/// without it.
///
/// 2. With `view.scene`, the scene is traced again without some limits of the records (error_trials).
///
/// 3. In the remaining pixels, the cause with the largest estimated error is chosen. If this is too small, it
/// is view-dependent shading.
///
/// Throws the errors of hybrid_picture. Both images must have the size of the file.
[[nodiscard]] CauseMap find_error_causes(FocusFrame& frame, const Image& image, const Image& reference,
                                         const CauseRequest& request);

}  // namespace postlens
