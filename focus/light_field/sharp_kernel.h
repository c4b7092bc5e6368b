// The blur kernel of a light source that is almost sharp in the image.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "focus/light_field/merged_highlights.h"
#include "focus/responses/kernel.h"
#include "focus/responses/response_model.h"

namespace postlens {

/// Returns the blur kernel of a light source that consists of rectangles of bright light: the mean of the
/// blur kernels of all their points, weighted by their light.
///
/// If a light is almost sharp, its kernel must be as accurate as this. For example, a light of radiance 60
/// that reaches 0.01 px into a dark pixel makes this pixel grey (radiance 0.6). A kernel for one point of the
/// light, or one whose position is rounded, would miss or exaggerate such a strip.
///
/// If the aperture is not round, a disc replaces a blur with a radius below 0.5 px.
///
/// - `parts`: the rectangles, each within one pixel and with some light; their positions are relative to
/// `centre_px`
/// - `centre_px`: position of the light source relative to the kernel's integer position, in px
/// - `map_px`: converts a lens point, in lens radii, to the displacement of the light's image, in px; the
///   kernel is wide, and expensive, if one of the displacements is
[[nodiscard]] Kernel sharp_kernel(std::span<const SourcePart> parts, const glm::dvec2& centre_px,
                                  const glm::dmat2& map_px, const ResponseModel& model, KernelReach reach);

}  // namespace postlens
