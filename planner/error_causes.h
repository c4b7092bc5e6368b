// Why a picture errs, pixel by pixel: what the records, the lens and the shutter say of it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

enum class ErrorCause : std::uint8_t {
    none,            ///< the pixel is right
    hidden_surface,  ///< the lens sees what no record shows
    visibility,      ///< the records show it, but the method mixed what should hide one another
    curvature_of_w,  ///< in mirrors or glass, other points of the lens see it elsewhere than was assumed
    view_dependent_shading,     ///< what remains: its colour differs from point to point of the lens
    path_and_depth_correlated,  ///< it moves through focus, or before what is blurred, while the shutter is
                                ///< open
    frame_edge,                 ///< light comes from beyond the recorded margin
    kernel_truncation,          ///< the circles of confusion were too few or cut off
    record_density,             ///< an edge is known to the quadtree's cells only, or the views are too few
};
inline constexpr std::size_t error_causes = 9;
/// "hidden-surface" and so on.
[[nodiscard]] std::string_view cause_name(ErrorCause cause);

struct CauseRequest {
    HybridSettings view;                ///< lens, shutter and motion; the method does not count
    std::optional<FocusMethod> method;  ///< how the picture was made, where that is known
    std::optional<int> depths;          ///< K of `scatter`, where that was given
    /// Pixels are wrong where a channel differs by more, encoded values.
    double wrong_above = 1.0 / 255;
};

struct CauseMap {
    int width = 0, height = 0;
    std::vector<ErrorCause> causes;                  ///< by pixel
    std::array<double, error_causes> error_share{};  ///< of the squared encoded error over all wrong pixels
};

/// For each wrong pixel the cause that explains most of its error. Causes that can be taken away are tried:
/// with finer circles of confusion (kernel_truncation), and with every surface in its place, at every
/// instant, as the light field of the records sees it from many points: visibility, path_and_depth_correlated
/// with a shutter, record_density for the light field of fewer views, curvature_of_w where another depth
/// model than W was used; with the scene at hand (`view.scene`) and over a tenth of the error left, with what
/// tracing it again would record (error_trials). What is then at most half as wrong was wrong for that
/// reason. Of the others each has an expected error that the records tell (hidden light and light beyond the
/// margin by the contrast around it, misplaced light, the floor of the records); the greatest is named if it
/// is a tenth of the error or more, else what no record tells: shading that changes over the lens. Errors as
/// hybrid_picture's; sizes must agree with the file's.
[[nodiscard]] CauseMap find_error_causes(FocusFrame& frame, const Image& image, const Image& reference,
                                         const CauseRequest& request);

}  // namespace postlens
